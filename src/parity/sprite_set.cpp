#include "gl/device_state.hpp"
#include "parity/depth_sprite_data.hpp"
#include "parity/parity_constants.hpp"

#include <lamina/parity/sprite_set.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace lamina {
namespace {

bool isInvertible(const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(matrix[column][row]))
                return false;
    const double determinant = glm::determinant(glm::dmat3(matrix));
    return matrix[0][3] == 0.0 && matrix[1][3] == 0.0 && matrix[2][3] == 0.0 &&
           matrix[3][3] == 1.0 && std::isnormal(determinant);
}

/// World to (column x, column y, fraction of the depth range).
glm::dmat4 worldToSprite(const GridTransform& transform, const glm::dmat4& localToWorld) {
    const double near = transform.nearDepth();
    const double range = transform.farDepth() - near;
    glm::dmat4 toFraction(1.0);
    toFraction[2][2] = 1.0 / range;
    toFraction[3][2] = -near / range;
    return toFraction * transform.worldToColumn() * glm::inverse(localToWorld);
}

/// Do single-precision numbers hold the map that the constants have: in range, and with the
/// determinant of `linear`, the map in double precision?
bool fitsFloats(const shared::LaminaSpriteConstants& constants, const glm::dmat3& linear) {
    glm::dmat3 rows(0.0);
    for (int row = 0; row < 3; ++row) {
        const glm::vec4& found = constants.worldToSprite[row];
        for (int column = 0; column < 4; ++column)
            if (!std::isfinite(found[column]))
                return false;
        rows[row] = glm::dvec3(found);
        const glm::vec3 most = glm::abs(glm::vec3(found));
        if (!std::isnormal(std::max({most.x, most.y, most.z})))
            return false;
    }
    const double exact = glm::determinant(linear);
    const double rounded = glm::determinant(rows);
    return std::isnormal(constants.scale.x) && std::isnormal(constants.scale.y) &&
           std::isnormal(rounded) && std::abs(rounded - exact) <= 0.5 * std::abs(exact);
}

/// Nothing where single-precision numbers do not hold them.
std::optional<shared::LaminaSpriteConstants> constantsOf(const SpriteInstance& instance) {
    const GridTransform& transform = *instance.sprite->transform();
    const glm::dmat4 map = worldToSprite(transform, instance.localToWorld);
    const glm::dmat4 rows = glm::transpose(map);
    // World vectors of a column in x, of one in y, and of the depth range.
    const glm::dmat3 steps = glm::inverse(glm::dmat3(map));
    const double range = glm::length(steps[2]);
    const double diagonal = std::hypot(glm::length(steps[0]), glm::length(steps[1]));
    shared::LaminaSpriteConstants constants{};
    for (int row = 0; row < 3; ++row)
        constants.worldToSprite[row] = glm::vec4(rows[row]);
    constants.scale = {range, diagonal / range, 0.0f, 0.0f};
    constants.size = {transform.size().x, transform.size().y, instance.sprite->layers(),
                      instance.inverted ? LAMINA_PARITY_INVERTED : 0u};
    if (!fitsFloats(constants, glm::dmat3(map)))
        return std::nullopt;
    return constants;
}

} // namespace

struct SpriteSet::Impl {
    std::shared_ptr<gl::DeviceState> device;
    gl::Buffer uniforms;
    std::vector<GLuint> textures;
    std::vector<std::weak_ptr<const char>> placements; ///< Of the textures.
    std::uint32_t maxTextures = 0;
};

SpriteSet::SpriteSet(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
SpriteSet::SpriteSet(SpriteSet&&) noexcept = default;
SpriteSet& SpriteSet::operator=(SpriteSet&&) noexcept = default;
SpriteSet::~SpriteSet() = default;

Result<SpriteSet> SpriteSet::create(const Device& device) {
    static_assert(kMaxSprites == LAMINA_PARITY_MAX_SPRITES);
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    const shared::ParityBlock empty{};
    auto uniforms = gl::createBuffer(impl->device, sizeof empty, &empty, GL_DYNAMIC_STORAGE_BIT,
                                     "sprite set", "lamina sprite set");
    if (!uniforms)
        return uniforms.error();
    impl->uniforms = std::move(*uniforms);
    GLint limit = 0;
    impl->device->gl.GetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &limit);
    impl->maxTextures = static_cast<std::uint32_t>(limit);
    return SpriteSet(std::move(impl));
}

Result<void> SpriteSet::update(std::span<const SpriteInstance> sprites) {
    if (sprites.size() > kMaxSprites)
        return Error{ErrorCode::InvalidArgument,
                     "sprite set: expected at most " + std::to_string(kMaxSprites) +
                         " sprites, found " + std::to_string(sprites.size()) +
                         "; test the others in another pass"};
    if (sprites.size() > mImpl->maxTextures)
        return Error{ErrorCode::DeviceLimit,
                     "sprite set: expected at most " + std::to_string(mImpl->maxTextures) +
                         " sprites, the texture units of a shader stage here, found " +
                         std::to_string(sprites.size()) + "; test the others in another pass"};
    shared::ParityBlock block{};
    std::vector<GLuint> textures;
    std::vector<std::weak_ptr<const char>> placements;
    for (std::size_t i = 0; i < sprites.size(); ++i) {
        const SpriteInstance& instance = sprites[i];
        const std::string operation = "sprite set: sprite " + std::to_string(i) + ": ";
        if (!instance.sprite || !instance.sprite->transform())
            return Error{ErrorCode::InvalidArgument,
                         operation + "expected a sprite that was built, found none; give it to "
                                     "SpriteBuilder::build() first"};
        if (!isInvertible(instance.localToWorld))
            return Error{ErrorCode::InvalidArgument,
                         operation + "expected a finite, affine and invertible localToWorld, found "
                                     "another matrix"};
        const auto constants = constantsOf(instance);
        if (!constants)
            return Error{ErrorCode::InvalidArgument,
                         operation + "expected a localToWorld whose inverse single-precision "
                                     "numbers hold, found one too large, too small or too flat; "
                                     "use other units"};
        block.sprites[i] = *constants;
        textures.push_back(instance.sprite->texture());
        placements.emplace_back(instance.sprite->data().placement);
    }
    block.count.x = static_cast<std::uint32_t>(sprites.size());
    mImpl->textures = std::move(textures);
    mImpl->placements = std::move(placements);
    mImpl->device->gl.NamedBufferSubData(mImpl->uniforms.id(), 0, sizeof block, &block);
    return {};
}

void SpriteSet::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit) const {
    const GladGLContext& gl = mImpl->device->gl;
    const GLuint buffer = mImpl->uniforms.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding, 1, &buffer);
    for (std::size_t i = 0; i < mImpl->textures.size(); ++i) {
        const auto unit = static_cast<GLuint>(textureUnit + i);
        gl.BindTextureUnit(unit, mImpl->placements[i].expired() ? 0 : mImpl->textures[i]);
        gl.BindSampler(unit, 0);
    }
}

std::optional<std::uint32_t> SpriteSet::outdatedSprite() const {
    for (std::size_t i = 0; i < mImpl->placements.size(); ++i)
        if (mImpl->placements[i].expired())
            return static_cast<std::uint32_t>(i);
    return std::nullopt;
}

std::uint32_t SpriteSet::size() const {
    return static_cast<std::uint32_t>(mImpl->textures.size());
}
std::uint64_t SpriteSet::gpuBytes() const {
    return mImpl->uniforms.bytes();
}

} // namespace lamina
