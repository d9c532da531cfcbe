#include "voxelize/epipolar_host_maps.hpp"

#include "core/finite.hpp"
#include "voxelize/epipolar_depth_maps.hpp"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <string>

namespace lamina {
namespace {

using detail::isFinite;

std::string text(const glm::uvec2& size) {
    return std::to_string(size.x) + " x " + std::to_string(size.y);
}

/// The frame (u, v, axis) around the eye, to world space.
glm::dmat4 frameToWorld(const EpipolarTransform& transform) {
    return {glm::dvec4(transform.u(), 0.0), glm::dvec4(transform.v(), 0.0),
            glm::dvec4(transform.axis(), 0.0), glm::dvec4(transform.eye(), 1.0)};
}

/// Do all lines of projection meet in the light (or run along its direction)?
bool projectsFrom(const glm::dmat4& worldToClip, const EpipolarTransform& transform) {
    const EpipolarLight& light = transform.light();
    const glm::dvec4 source = transform.isDirectional()
                                  ? glm::dvec4(glm::normalize(light.direction), 0.0)
                                  : glm::dvec4(light.position, 1.0);
    constexpr double kTolerance = 1e-4;
    for (const int row : {0, 1, 3}) {
        const glm::dvec4 coefficients = glm::row(worldToClip, row);
        const double magnitude = glm::dot(glm::abs(coefficients), glm::abs(source)) +
                                 glm::length(glm::dvec3(coefficients)) * transform.lightDistance();
        if (!(std::abs(glm::dot(coefficients, source)) <= kTolerance * magnitude))
            return false;
    }
    return true;
}

class HostMap {
public:
    HostMap(const gl::DeviceState& device, const LightDepthMap& map,
            const EpipolarTransform& transform, std::size_t index)
        : mDevice(device)
        , mMap(map)
        , mTransform(transform)
        , mIndex(index) {}

    [[nodiscard]] Result<shared::LaminaEpipolarMap> make() const;

private:
    [[nodiscard]] Error invalid(const std::string& found) const {
        return {ErrorCode::InvalidArgument,
                "epipolar voxelize: depth map " + std::to_string(mIndex) + ": " + found};
    }
    [[nodiscard]] Result<glm::uvec3> textureSize() const;
    [[nodiscard]] Result<void> makePlanar(const glm::uvec3& texture,
                                          shared::LaminaEpipolarMap& block) const;
    [[nodiscard]] Result<void> makeCube(const glm::uvec3& texture,
                                        shared::LaminaEpipolarMap& block) const;
    [[nodiscard]] Result<void> makeHemisphere(const glm::uvec3& texture,
                                              shared::LaminaEpipolarMap& block) const;
    [[nodiscard]] Result<glm::uvec2> usedSize(const glm::uvec3& texture) const;

    const gl::DeviceState& mDevice;
    const LightDepthMap& mMap;
    const EpipolarTransform& mTransform;
    std::size_t mIndex;
};

Result<glm::uvec3> HostMap::textureSize() const {
    const GladGLContext& gl = mDevice.gl;
    if (!gl.IsTexture(mMap.texture))
        return invalid("expected the name of a GL texture, found " + std::to_string(mMap.texture));
    GLint target = 0;
    gl.GetTextureParameteriv(mMap.texture, GL_TEXTURE_TARGET, &target);
    const GLint expected = mMap.kind == DepthMapKind::Texture2D     ? GL_TEXTURE_2D
                           : mMap.kind == DepthMapKind::TextureCube ? GL_TEXTURE_CUBE_MAP
                                                                    : GL_TEXTURE_2D_ARRAY;
    if (target != expected)
        return invalid("expected a texture of the kind that the map names, found target " +
                       std::to_string(target) + " instead of " + std::to_string(expected));
    glm::ivec3 size(0);
    gl.GetTextureLevelParameteriv(mMap.texture, 0, GL_TEXTURE_WIDTH, &size.x);
    gl.GetTextureLevelParameteriv(mMap.texture, 0, GL_TEXTURE_HEIGHT, &size.y);
    gl.GetTextureLevelParameteriv(mMap.texture, 0, GL_TEXTURE_DEPTH, &size.z);
    GLint depthType = GL_NONE;
    GLint redType = GL_NONE;
    gl.GetTextureLevelParameteriv(mMap.texture, 0, GL_TEXTURE_DEPTH_TYPE, &depthType);
    gl.GetTextureLevelParameteriv(mMap.texture, 0, GL_TEXTURE_RED_TYPE, &redType);
    const auto isReal = [](GLint type) {
        return type == GL_FLOAT || type == GL_UNSIGNED_NORMALIZED;
    };
    if (size.x == 0 || size.y == 0 || !(isReal(depthType) || isReal(redType)))
        return invalid("expected a texture with storage of a depth or float format, found " +
                       text(glm::uvec2(size)) + " texels of another");
    return glm::uvec3(size);
}

Result<glm::uvec2> HostMap::usedSize(const glm::uvec3& texture) const {
    const glm::uvec2 whole(texture);
    const glm::uvec2 size = mMap.size == glm::uvec2(0) ? whole : mMap.size;
    if (size.x == 0 || size.y == 0 || mMap.firstTexel.x > whole.x || mMap.firstTexel.y > whole.y ||
        size.x > whole.x - mMap.firstTexel.x || size.y > whole.y - mMap.firstTexel.y)
        return invalid("expected a part inside the texture of " + text(whole) + " texels, found " +
                       text(size) + " from " + text(mMap.firstTexel));
    const bool isArray =
        mMap.kind == DepthMapKind::TextureArray || mMap.kind == DepthMapKind::HemisphereArray;
    if (isArray && mMap.layer >= texture.z)
        return invalid("expected a layer below " + std::to_string(texture.z) + ", found " +
                       std::to_string(mMap.layer));
    return size;
}

Result<void> HostMap::makePlanar(const glm::uvec3& texture,
                                 shared::LaminaEpipolarMap& block) const {
    const auto used = usedSize(texture);
    if (!used)
        return used.error();
    const glm::uvec2 size = *used;
    if (!isFinite(mMap.worldToClip) || !projectsFrom(mMap.worldToClip, mTransform))
        return invalid("expected a finite worldToClip whose lines of projection meet in the light "
                       "(directional: run along it), found another; give the matrix and the light "
                       "that the map was drawn with");
    glm::dmat4 clipToTexel(1.0);
    const double depthScale = mMap.zeroToOneDepth ? 1.0 : 0.5;
    clipToTexel[0][0] = clipToTexel[3][0] = 0.5 * size.x;
    clipToTexel[1][1] = clipToTexel[3][1] = 0.5 * size.y;
    clipToTexel[2][2] = depthScale;
    clipToTexel[3][2] = 1.0 - depthScale;
    const glm::dmat4 toTexel = clipToTexel * mMap.worldToClip * frameToWorld(mTransform);
    const glm::dmat4 fromTexel = glm::inverse(toTexel);
    if (!isFinite(fromTexel))
        return invalid("expected an invertible worldToClip, found a singular one");
    block.window = glm::vec4(glm::vec2(mMap.firstTexel), glm::vec2(size));
    block.depth = {mMap.emptyDepth, 0.0f, 0.0f, 0.0f};
    block.layers = {static_cast<int>(mMap.layer), 0, 0, 0};
    block.toTexel = glm::mat4(toTexel);
    block.fromTexel = glm::mat4(fromTexel);
    return {};
}

Result<void> HostMap::makeCube(const glm::uvec3& texture, shared::LaminaEpipolarMap& block) const {
    if (mTransform.isDirectional())
        return invalid("expected a 2D map for a directional light, found a cube map");
    const glm::dmat4& projection = mMap.faceProjection;
    const double c = projection[3][2];
    constexpr double kTolerance = 1e-5;
    if (!isFinite(projection) || std::abs(std::abs(projection[0][0]) - 1.0) > kTolerance ||
        std::abs(std::abs(projection[1][1]) - 1.0) > kTolerance ||
        std::abs(projection[2][3] + 1.0) > kTolerance || c == 0.0)
        return invalid("expected the perspective projection of a right angle that the faces were "
                       "drawn with as faceProjection, found another matrix");
    // ndc = (z p22 + p32) / -z, so the distance -z = p32 / (p22 + ndc).
    const double d = projection[2][2];
    const glm::dvec2 distance =
        mMap.zeroToOneDepth ? glm::dvec2(c, d) : glm::dvec2(0.5 * c, 0.5 * (d - 1.0));
    block.depth = glm::vec4(
        glm::dvec4(mMap.emptyDepth, distance.x, distance.y, static_cast<double>(texture.x)));
    const glm::dmat3 rotation(frameToWorld(mTransform));
    block.toTexel = glm::mat4(glm::dmat4(rotation));
    block.fromTexel = glm::mat4(glm::dmat4(glm::transpose(rotation)));
    return {};
}

Result<void> HostMap::makeHemisphere(const glm::uvec3& texture,
                                     shared::LaminaEpipolarMap& block) const {
    const auto size = usedSize(texture);
    if (!size)
        return size.error();
    const glm::dmat3& rotation = mMap.worldToHemisphere;
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    constexpr double kTolerance = 1e-5;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(product[column][row] - (row == column ? 1.0 : 0.0)) < kTolerance))
                return invalid("expected a rotation as worldToHemisphere, found another matrix");
    if (mTransform.isDirectional())
        return invalid("expected a 2D map for a directional light, found a hemisphere");
    block.window = glm::vec4(glm::vec2(mMap.firstTexel), glm::vec2(*size));
    block.depth = {mMap.emptyDepth, 0.0f, 0.0f, 0.0f};
    block.layers = {static_cast<int>(mMap.layer), 0, 0, 0};
    const glm::dmat3 fromFrame = rotation * glm::dmat3(frameToWorld(mTransform));
    block.toTexel = glm::mat4(glm::dmat4(fromFrame));
    block.fromTexel = glm::mat4(glm::dmat4(glm::transpose(fromFrame)));
    return {};
}

Result<shared::LaminaEpipolarMap> HostMap::make() const {
    const auto texture = textureSize();
    if (!texture)
        return texture.error();
    shared::LaminaEpipolarMap block{};
    setLight(block, mTransform, static_cast<std::uint32_t>(mIndex));
    Result<void> made;
    if (mMap.kind == DepthMapKind::TextureCube)
        made = makeCube(*texture, block);
    else if (mMap.kind == DepthMapKind::HemisphereArray)
        made = makeHemisphere(*texture, block);
    else
        made = makePlanar(*texture, block);
    if (!made)
        return made.error();
    return block;
}

} // namespace

Result<shared::LaminaEpipolarMap> makeHostMap(const gl::DeviceState& device,
                                              const LightDepthMap& map,
                                              const EpipolarTransform& transform,
                                              std::size_t index) {
    return HostMap(device, map, transform, index).make();
}

} // namespace lamina
