#include "area_light/imperfect_maps.hpp"

#include "area_light/imperfect_constants.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

namespace lamina {
namespace {

constexpr const char* kOperation = "area light imperfect maps";
constexpr std::uint32_t kPointsPerGroup = 64;

/// Where a light's map looks: the rows that splats read, and the same for rectification.
struct MapFrame {
    shared::LaminaImperfectMap rows{};
    LightDepthMap map;
};

glm::dvec3 orthogonal(const glm::dvec3& axis) {
    const glm::dvec3 other = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(glm::cross(other, axis));
}

MapFrame hemisphere(const VirtualLight& light) {
    const glm::dvec3 s = orthogonal(light.normal);
    const glm::dvec3 axes[3] = {s, glm::cross(light.normal, s), light.normal};
    MapFrame frame;
    for (int row = 0; row < 3; ++row) {
        frame.rows.rows[row] =
            glm::vec4(glm::dvec4(axes[row], -glm::dot(axes[row], light.light.position)));
        for (int column = 0; column < 3; ++column)
            frame.map.worldToHemisphere[column][row] = axes[row][column];
    }
    frame.map.kind = DepthMapKind::HemisphereArray;
    return frame;
}

/// Around all that the eye sees, along the light, from as far before it as the scene is large.
MapFrame slab(const VirtualLight& light, const EpipolarTransform& transform) {
    const glm::dvec3 along = glm::normalize(light.light.direction);
    const glm::dvec3 s = orthogonal(along);
    const glm::dvec3 t = glm::cross(along, s);
    const EpipolarRanges& ranges = transform.ranges();
    const double reach = std::min(ranges.phi.y, ranges.farDistance);
    const double depth = 2.0 * ranges.farDistance;
    const glm::dvec4 rows[4] = {glm::dvec4(s, -glm::dot(s, transform.eye())) / reach,
                                glm::dvec4(t, -glm::dot(t, transform.eye())) / reach,
                                (glm::dvec4(along, -glm::dot(along, transform.eye())) +
                                 glm::dvec4(0.0, 0.0, 0.0, 0.5 * depth)) /
                                    depth,
                                glm::dvec4(0.0, 0.0, 0.0, 1.0)};
    MapFrame frame;
    for (int row = 0; row < 4; ++row) {
        if (row < 3)
            frame.rows.rows[row] = glm::vec4(rows[row]);
        frame.map.worldToClip = glm::row(frame.map.worldToClip, row, rows[row]);
    }
    frame.map.kind = DepthMapKind::TextureArray;
    frame.map.zeroToOneDepth = true;
    return frame;
}

} // namespace

ImperfectMapMaker::ImperfectMapMaker(std::shared_ptr<gl::DeviceState> device,
                                     const AreaLightDesc& desc, PointSamples samples,
                                     HoleFiller filler)
    : mDevice(std::move(device))
    , mDesc(desc)
    , mSamples(std::move(samples))
    , mFiller(std::move(filler))
    , mConstants(gl::Buffer::create(mDevice, "lamina splat pass"))
    , mFrames(gl::Buffer::create(mDevice, "lamina imperfect maps")) {}

Result<ImperfectMapMaker> ImperfectMapMaker::create(std::shared_ptr<gl::DeviceState> device,
                                                    const AreaLightDesc& desc) {
    auto samples = PointSamples::create(device, desc.imperfect.points);
    if (!samples)
        return samples.error();
    auto filler = HoleFiller::create(device, desc.mapTexels, desc.imperfect.holeLevels);
    if (!filler)
        return filler.error();
    ImperfectMapMaker made(std::move(device), desc, std::move(*samples), std::move(*filler));
    const char* const values[2] = {"0", "1"};
    for (std::size_t i = 0; i < 2; ++i) {
        const auto built =
            gl::findOrBuildProgram(*made.mDevice, {"lamina imperfect maps",
                                                   {{GL_COMPUTE_SHADER, "area_light/splat.comp"}},
                                                   {{"LAMINA_SPLAT_DIRECTIONAL", values[i]}}});
        if (!built)
            return built.error();
        made.mSplatPrograms[i] = *built;
    }
    return made;
}

bool ImperfectMapMaker::canServe(std::span<const VirtualLight> lights) {
    const auto isDirectional = [](const VirtualLight& light) {
        return light.light.kind == LightKind::Directional;
    };
    return std::ranges::all_of(lights, isDirectional) ||
           std::ranges::all_of(lights, &VirtualLight::isLambertian);
}

Result<void> ImperfectMapMaker::reserve(std::uint32_t maps) {
    if (maps <= mLayers)
        return {};
    const glm::uvec2 size = mFiller.layerSize();
    auto made = gl::createTextureArray(mDevice, GL_R32F, 4, size.x, size.y, maps, kOperation,
                                       "lamina imperfect maps");
    if (!made)
        return made.error();
    mMaps = std::move(*made);
    mLayers = maps;
    return {};
}

void ImperfectMapMaker::clear(std::uint32_t maps) {
    const float empty = std::bit_cast<float>(LAMINA_SPLAT_EMPTY);
    const gl::PixelUnpackGuard unpack(*mDevice);
    // The pyramid beside the maps is written before it is read.
    const auto side = static_cast<GLsizei>(mDesc.mapTexels);
    mDevice->gl.ClearTexSubImage(mMaps.id(), 0, 0, 0, 0, side, side, static_cast<GLsizei>(maps),
                                 GL_RED, GL_FLOAT, &empty);
}

void ImperfectMapMaker::splat(std::uint32_t maps, bool isDirectional) {
    const gl::DebugGroup group(*mDevice, "lamina: splat point samples");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_SPLAT_BINDING_COUNT);
    const gl::ImageUnitGuard images(*mDevice, 1);
    shared::LaminaSplatConstants constants{};
    const std::uint32_t perMap = mDesc.imperfect.pointsPerMap;
    constants.counts = {mDesc.mapTexels, mSamples.count(), perMap, 0};
    constants.numbers.x =
        std::sqrt(static_cast<float>(mSamples.count()) / static_cast<float>(perMap));
    gl.NamedBufferData(mConstants.id(), sizeof constants, &constants, GL_STREAM_DRAW);
    const GLuint uniforms = mConstants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SPLAT_UNIFORM_BINDING, 1, &uniforms);
    const GLuint buffers[LAMINA_SPLAT_BINDING_COUNT] = {mSamples.triangles(), mSamples.points(),
                                                        mFrames.id()};
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, LAMINA_SPLAT_BINDING_COUNT, buffers);
    // The bits of positive floats are in the floats' order.
    gl.BindImageTexture(LAMINA_SPLAT_IMAGE, mMaps.id(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
    gl.UseProgram(mSplatPrograms[isDirectional ? 1 : 0]);
    gl.DispatchCompute((perMap + kPointsPerGroup - 1) / kPointsPerGroup, maps, 1);
    gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

Result<void> ImperfectMapMaker::prepare(std::span<const GeometrySource> sources,
                                        std::uint32_t maps) {
    if (auto room = reserve(maps); !room)
        return room;
    return mSamples.prepare(sources);
}

Result<std::vector<LightDepthMap>>
ImperfectMapMaker::make(std::span<const GeometrySource> sources,
                        std::span<const VirtualLight> lights,
                        std::span<const EpipolarTransform> transforms) {
    const auto count = static_cast<std::uint32_t>(lights.size());
    const bool isDirectional = lights.front().light.kind == LightKind::Directional;
    glm::dvec3 middle(0.0);
    for (const VirtualLight& light : lights)
        middle += light.light.position / static_cast<double>(lights.size());
    double near = 0.0;
    if (!isDirectional) {
        for (const VirtualLight& light : lights)
            near = std::max(near, glm::distance(light.light.position, middle));
        // A light without extent would draw all samples to the nearest triangle.
        constexpr double kLeastShare = 0.02;
        near = std::max(near, kLeastShare * transforms.front().ranges().farDistance);
    }
    if (auto drawn = mSamples.draw(sources, middle, near); !drawn)
        return drawn.error();

    std::vector<shared::LaminaImperfectMap> rows;
    std::vector<LightDepthMap> maps;
    for (std::uint32_t i = 0; i < count; ++i) {
        MapFrame frame = isDirectional ? slab(lights[i], transforms[i]) : hemisphere(lights[i]);
        frame.map.texture = mMaps.id();
        frame.map.layer = i;
        frame.map.size = glm::uvec2(mDesc.mapTexels);
        frame.map.emptyDepth = std::bit_cast<float>(LAMINA_SPLAT_EMPTY);
        rows.push_back(frame.rows);
        maps.push_back(frame.map);
    }
    mDevice->gl.NamedBufferData(mFrames.id(), static_cast<GLsizeiptr>(rows.size() * sizeof rows[0]),
                                rows.data(), GL_STREAM_DRAW);
    clear(count);
    splat(count, isDirectional);
    mFiller.fill(mMaps.id(), count);
    return maps;
}

} // namespace lamina
