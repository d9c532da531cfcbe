#include "transmittance/opaque_map.hpp"

#include "core/finite.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <string>

namespace lamina {
namespace {

/// Clip space of a grid's camera, depth from 1 at the light to 0 far away, as our depth maps keep
/// it.
glm::dmat4 worldToClip(const GridTransform& grid) {
    const glm::dmat4 rows = glm::transpose(grid.worldToColumn());
    const glm::dvec4 w = rows[3];
    const double near = grid.nearDepth();
    const double far = grid.farDepth();
    glm::dmat4 clip;
    clip[0] = 2.0 / grid.size().x * rows[0] - w;
    clip[1] = 2.0 / grid.size().y * rows[1] - w;
    clip[2] = grid.projection() == Projection::Perspective
                  ? glm::dvec4(0.0, 0.0, 0.0, near)
                  : (glm::dvec4(0.0, 0.0, 0.0, far) - rows[2]) / (far - near);
    clip[3] = w;
    return glm::transpose(clip);
}

glm::dmat4 clipToTexel(const glm::dvec2& size, double depthScale, double depthOffset) {
    glm::dmat4 matrix(1.0);
    matrix[0][0] = 0.5 * size.x;
    matrix[1][1] = 0.5 * size.y;
    matrix[2][2] = depthScale;
    matrix[3] = {0.5 * size.x, 0.5 * size.y, depthOffset, 1.0};
    return matrix;
}

/// World to eye of a cube map's face, as GL orients them.
glm::dmat4 cubeFaceView(const glm::dvec3& light, int face) {
    constexpr glm::dvec3 kAlong[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                      {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    constexpr glm::dvec3 kUp[6] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1},
                                   {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
    return glm::lookAt(light, light + kAlong[face], kUp[face]);
}

GLenum targetOf(DepthMapKind kind) {
    constexpr GLenum kTargets[] = {GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_CUBE_MAP};
    return kTargets[static_cast<std::size_t>(kind)];
}

Error invalidMap(const std::string& found) {
    return Error{ErrorCode::InvalidArgument,
                 "transmittance: expected a host shadow map that is a " + found};
}

} // namespace

OpaqueMap::OpaqueMap(std::shared_ptr<gl::DeviceState> device, std::uint32_t texels)
    : mDevice(std::move(device))
    , mRenderer(mDevice, texels)
    , mTexels(texels) {}

Result<void> OpaqueMap::draw(std::span<const GeometrySource> sources, const LightFaces& faces) {
    auto programs = mRenderer.prepare(sources);
    if (!programs)
        return programs.error();
    if (auto reserved = mRenderer.reserve(static_cast<std::uint32_t>(faces.grids.size()));
        !reserved)
        return reserved;
    std::vector<DepthMapFace> maps;
    mWorldToTexel.clear();
    for (const GridTransform& grid : faces.grids) {
        const glm::dmat4 matrix = worldToClip(grid);
        maps.push_back({matrix, grid.projection() == Projection::Orthographic});
        mWorldToTexel.push_back(clipToTexel(glm::dvec2(mTexels), 1.0, 0.0) * matrix);
    }
    mRenderer.draw(sources, *programs, maps);
    mIsPresent = true;
    mIsCopy = false;
    mSize = glm::uvec2(mTexels);
    mEmptyDepth = 0.0f;
    mLayerOfAxis = faces.ofAxis;
    return {};
}

Result<void> OpaqueMap::reserveCopy(GLenum format, const glm::uvec3& size) {
    if (format == mCopyFormat && size == mCopySize)
        return {};
    // At most eight bytes: depth in 32 bits and stencil.
    auto texture = gl::createTextureArray(mDevice, format, 8, size.x, size.y, size.z,
                                          "transmittance: host shadow map", "lamina opaque map");
    if (!texture)
        return texture.error();
    mCopy = std::move(*texture);
    mCopyFormat = format;
    mCopySize = size;
    return {};
}

Result<void> OpaqueMap::copy(const LightDepthMap& map, const TransmittanceLight& light) {
    const GladGLContext& gl = mDevice->gl;
    if (map.kind > DepthMapKind::TextureCube)
        return invalidMap("2D, array or cube texture, found DepthMapKind value " +
                          std::to_string(static_cast<int>(map.kind)));
    const bool isCube = map.kind == DepthMapKind::TextureCube;
    const glm::dmat4& projection = isCube ? map.faceProjection : map.worldToClip;
    if (!detail::isFinite(glm::mat4(projection)) || glm::determinant(projection) == 0.0)
        return invalidMap(
            std::string("texture drawn with an invertible ") +
            (isCube ? "faceProjection" : "worldToClip") +
            " of finite floats, found another matrix; pass the projection that it was drawn with");
    if (!gl.IsTexture(map.texture))
        return invalidMap("GL texture, found the name " + std::to_string(map.texture));
    GLint target = 0;
    gl.GetTextureParameteriv(map.texture, GL_TEXTURE_TARGET, &target);
    if (static_cast<GLenum>(target) != targetOf(map.kind))
        return invalidMap("texture of the kind that it states, found another target");
    GLint width = 0, height = 0, layers = 1, format = 0;
    gl.GetTextureLevelParameteriv(map.texture, 0, GL_TEXTURE_WIDTH, &width);
    gl.GetTextureLevelParameteriv(map.texture, 0, GL_TEXTURE_HEIGHT, &height);
    gl.GetTextureLevelParameteriv(map.texture, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    if (map.kind == DepthMapKind::TextureArray)
        gl.GetTextureLevelParameteriv(map.texture, 0, GL_TEXTURE_DEPTH, &layers);
    const glm::uvec2 whole(width, height);
    const glm::uvec2 first = isCube ? glm::uvec2(0) : map.firstTexel;
    const glm::uvec2 size = isCube || map.size == glm::uvec2(0) ? whole : map.size;
    const std::uint32_t layer = map.kind == DepthMapKind::TextureArray ? map.layer : 0;
    if (size.x == 0 || size.y == 0 || first.x > whole.x || first.y > whole.y ||
        size.x > whole.x - first.x || size.y > whole.y - first.y ||
        layer >= static_cast<std::uint32_t>(layers))
        return invalidMap("texture that holds the part to use, found one of " +
                          std::to_string(width) + " x " + std::to_string(height) + ", " +
                          std::to_string(layers) + " layers");
    const std::uint32_t count = isCube ? 6 : 1;
    if (auto reserved = reserveCopy(static_cast<GLenum>(format), {size, count}); !reserved)
        return reserved;
    const gl::DebugGroup group(*mDevice, "lamina: copy shadow map");
    gl.CopyImageSubData(map.texture, targetOf(map.kind), 0, static_cast<GLint>(first.x),
                        static_cast<GLint>(first.y), static_cast<GLint>(layer), mCopy.id(),
                        GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, static_cast<GLsizei>(size.x),
                        static_cast<GLsizei>(size.y), static_cast<GLsizei>(count));

    mWorldToTexel.clear();
    const double depthScale = map.zeroToOneDepth ? 1.0 : 0.5;
    const glm::dmat4 toTexel = clipToTexel(glm::dvec2(size), depthScale, 1.0 - depthScale);
    for (int face = 0; face < static_cast<int>(count); ++face)
        mWorldToTexel.push_back(isCube ? toTexel * map.faceProjection *
                                             cubeFaceView(light.position, face)
                                       : toTexel * map.worldToClip);
    mIsPresent = true;
    mIsCopy = true;
    mSize = size;
    mEmptyDepth = map.emptyDepth;
    mLayerOfAxis = isCube ? std::array<int, 6>{0, 1, 2, 3, 4, 5} : std::array<int, 6>{};
    return {};
}

void OpaqueMap::describe(shared::LaminaTransmittanceConstants& constants) const {
    if (!mIsPresent)
        return;
    constants.modes.y |= LAMINA_TRANSMITTANCE_OPAQUE_MAP;
    constants.modes.z = mSize.x;
    constants.modes.w = mSize.y;
    constants.scalars.y = mEmptyDepth;
    constants.scalars.z = mEmptyDepth > 0.5f ? 1.0f : -1.0f;
    for (std::size_t i = 0; i < mWorldToTexel.size(); ++i)
        constants.worldToOpaque[i] = glm::mat4(mWorldToTexel[i]);
    for (int axis = 0; axis < 6; ++axis)
        constants.opaqueLayers[axis / 4][axis % 4] = mLayerOfAxis[static_cast<std::size_t>(axis)];
}

GLuint OpaqueMap::texture() const {
    if (!mIsPresent)
        return 0;
    return mIsCopy ? mCopy.id() : mRenderer.texture().id();
}

} // namespace lamina
