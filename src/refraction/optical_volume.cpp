#include "refraction/optical_volume.hpp"

#include "core/finite.hpp"
#include "gl/binding_guards.hpp"
#include "gl/state_guard.hpp"
#include "refraction/refraction_constants.hpp"
#include "refraction/refraction_settings.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <string>

namespace lamina {
namespace {

constexpr std::string_view kOperation = "refraction volume";
constexpr GLuint kGroup = 8;
/// Voxels of empty space around the object: look-ups at its surface reach one.
constexpr double kMargin = 2.0;
/// lamina/shared/volume_block.glsl
constexpr GLuint kVolumeUnits = 6;

glm::vec4 opticsOf(const Material& material) {
    return {material.refractiveIndex, material.transmission * glm::vec3(material.color)};
}

/// What all materials share, if they do.
std::optional<glm::vec4> sharedOpticsOf(std::span<const Material> materials) {
    if (materials.empty())
        return opticsOf(Material{});
    for (const Material& material : materials)
        if (opticsOf(material) != opticsOf(materials.front()))
            return {};
    return opticsOf(materials.front());
}

/// Shaders square lengths, as floats: the longest side of a box is at least one over this, and no
/// coordinate is beyond it.
constexpr double kFarthest = 1e15;

Result<void> checkIndices(std::span<const Material> materials) {
    for (std::size_t i = 0; i < materials.size(); ++i)
        if (materials[i].refractiveIndex > kGreatestIndex)
            return Error{ErrorCode::InvalidArgument,
                         "refraction: material " + std::to_string(i) +
                             ": expected a refractive index of 1 to 4, found " +
                             std::to_string(materials[i].refractiveIndex)};
    return {};
}

Result<void> checkBounds(const Box3& bounds) {
    const auto invalid = [](const std::string& text) {
        return Error{ErrorCode::InvalidArgument, "refraction: expected " + text};
    };
    if (bounds.isEmpty() || !detail::isFinite(bounds))
        return invalid("finite bounds that hold the object, found none");
    const glm::dvec3 size = bounds.size();
    const auto greatest = [](const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); };
    if (greatest(size) < 1.0 / kFarthest)
        return invalid("bounds of at least 1e-15 along their longest side, found a point");
    if (greatest(glm::max(glm::abs(bounds.min), glm::abs(bounds.max))) > kFarthest)
        return invalid("bounds within 1e15 of the origin, found farther ones");
    return {};
}

} // namespace

Result<OpticalVolume> OpticalVolume::create(const Device& device, std::uint32_t voxels,
                                            float slabOverlap) {
    auto voxelizer = VolumeVoxelizer::create(device, {.slabOverlap = slabOverlap});
    if (!voxelizer)
        return voxelizer.error();
    VolumeLayout layout;
    layout.count = VolumeFormat::None;
    layout.normal = VolumeFormat::RGBA16F;
    layout.optics = VolumeFormat::RGBA16F;
    auto planes = VolumeGrid::create(device, layout);
    if (!planes)
        return planes.error();
    layout.color = VolumeFormat::RGBA16F;
    auto optics = VolumeGrid::create(device, layout);
    if (!optics)
        return optics.error();
    return OpticalVolume(device.state(), std::move(*voxelizer), std::move(*planes),
                         std::move(*optics), voxels);
}

Result<void> OpticalVolume::reserve() {
    const auto cube = [&](gl::Texture& texture, GLenum format, std::uint32_t bytes,
                          std::uint32_t size) -> Result<void> {
        if (texture)
            return {};
        auto made = gl::createTexture3d(mDevice, format, bytes, size, size, size, kOperation,
                                        "lamina refraction volume");
        if (!made)
            return made.error();
        texture = std::move(*made);
        return {};
    };
    if (auto made = cube(mPlanes, GL_RGBA16F, 8, mVoxels); !made)
        return made;
    const std::uint32_t bricks = (mVoxels + LAMINA_REFRACTION_BRICK - 1) / LAMINA_REFRACTION_BRICK;
    if (auto made = cube(mBricks, GL_R8, 1, bricks); !made)
        return made;
    return mSharedOptics ? Result<void>{} : cube(mOptics, GL_RGBA16F, 8, mVoxels);
}

Result<void> OpticalVolume::merge(const VolumeGrid& along, int axis) {
    const auto program =
        gl::findOrBuildProgram(*mDevice, {"lamina refraction volume",
                                          {{GL_COMPUTE_SHADER, "refraction/volume_merge.comp"}},
                                          {{"LAMINA_MERGE_OPTICS", mSharedOptics ? "0" : "1"}}});
    if (!program)
        return program.error();
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard compute(*mDevice, 1, 0);
    const gl::TextureUnitGuard textures(*mDevice, 0, kVolumeUnits);
    const gl::ImageUnitGuard images(*mDevice, 3);
    along.bind(0, 0);
    gl.BindImageTexture(0, mPlanes.id(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_RGBA16F);
    gl.BindImageTexture(1, mOptics.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    gl.BindImageTexture(2, mBricks.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R8);
    gl.UseProgram(*program);
    gl.ProgramUniform1i(*program, 0, axis);
    gl.ProgramUniform1i(*program, 1, axis == 0 ? 1 : 0);
    const GLuint groups = (mVoxels + kGroup - 1) / kGroup;
    gl.DispatchCompute(groups, groups, mVoxels);
    gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                     GL_TEXTURE_UPDATE_BARRIER_BIT);
    return {};
}

Result<VolumeStats> OpticalVolume::build(std::span<const GeometrySource> sources,
                                         std::span<const Material> materials, const Box3& bounds) {
    if (auto valid = checkBounds(bounds); !valid)
        return valid.error();
    if (auto valid = checkIndices(materials); !valid)
        return valid.error();
    mSharedOptics = sharedOpticsOf(materials);
    if (auto reserved = reserve(); !reserved)
        return reserved.error();
    const glm::dvec3 size = bounds.size();
    const double extent = std::max({size.x, size.y, size.z});
    const double half = 0.5 * extent * mVoxels / (mVoxels - 2.0 * kMargin);
    const Box3 cube{bounds.center() - half, bounds.center() + half};
    mPlace = {glm::vec3(cube.min), static_cast<float>(mVoxels / (2.0 * half))};
    mDevice->gl.ClearTexImage(mBricks.id(), 0, GL_RED, GL_FLOAT, nullptr);
    VolumeGrid& along = mSharedOptics ? mPlanesAlong : mOpticsAlong;
    VolumeStats stats;
    for (int axis = 0; axis < 3; ++axis) {
        const auto grid = GridTransform::box(cube, glm::uvec3(mVoxels), static_cast<Axis>(axis));
        if (!grid)
            return grid.error();
        const auto voxelized = mVoxelizer.voxelize(sources, materials, *grid, along);
        if (!voxelized)
            return voxelized.error();
        stats.sources = voxelized->sources;
        stats.passes += voxelized->passes;
        stats.meshTriangles = voxelized->meshTriangles;
        stats.scratchBytes = voxelized->scratchBytes;
        if (auto merged = merge(along, axis); !merged)
            return merged.error();
    }
    stats.volumeBytes = gpuBytes();
    return stats;
}

void OpticalVolume::bind(GLuint unit) const {
    const GLuint textures[] = {mPlanes.id(), mOptics.id(), mBricks.id()};
    for (GLuint i = 0; i < 3; ++i) {
        mDevice->gl.BindTextureUnit(unit + i, textures[i]);
        mDevice->gl.BindSampler(unit + i, 0);
    }
}

std::uint64_t OpticalVolume::gpuBytes() const {
    return mPlanes.bytes() + mOptics.bytes() + mBricks.bytes() + mPlanesAlong.gpuBytes() +
           mOpticsAlong.gpuBytes();
}

} // namespace lamina
