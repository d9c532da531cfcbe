#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/parity/depth_sprite.hpp>

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace lamina {

/// A sprite and its place in the world.
struct SpriteInstance {
    const DepthSprite* sprite = nullptr; ///< Built; the set does not keep the pointer.
    /// From the space that the sprite was built in to the world: rigid shapes move without being
    /// built again ([TD08] 3.1: position and orientation). Affine, not singular, also in the single
    /// precision that shaders have: no scale by 1e-40, say. One sprite may stand in several places.
    glm::dmat4 localToWorld{1.0};
    bool inverted = false; ///< What lies outside the shape counts as inside.
};

/// Sprites that shaders test together: what lamina/parity.glsl reads. Move-only; see Device for
/// threads and lifetime.
class LAMINA_API SpriteSet {
public:
    static constexpr std::uint32_t kMaxSprites = 32;

    /// An empty set. Errors: OutOfMemory.
    [[nodiscard]] static Result<SpriteSet> create(const Device& device);

    SpriteSet(SpriteSet&&) noexcept;
    SpriteSet& operator=(SpriteSet&&) noexcept;
    ~SpriteSet();

    /// Sprite s of the shader is sprites[s]. Call it again after a sprite was built with other
    /// columns, layers or another transform, and after its place in the world changed; see
    /// outdatedSprite().
    /// Errors: InvalidArgument (more than 32, a sprite that is null or not built, a matrix that is
    /// singular, in single precision too, or not affine), DeviceLimit (more sprites than a shader
    /// stage has texture units); the set is then unchanged. Does not wait for the GPU.
    [[nodiscard]] Result<void> update(std::span<const SpriteInstance> sprites);

    /// Binds the uniform buffer to LAMINA_PARITY_BLOCK_BINDING and the textures, without sampler
    /// objects, to units from LAMINA_PARITY_TEXTURE_UNIT on, of a shader whose LAMINA_PARITY_COUNT
    /// is at least size(). The unit of a sprite that is outdated gets no texture: what shaders say
    /// of it means nothing. GL: changes these bindings; the caller restores them if need be.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0) const;

    /// The first sprite that, since update(), was built with other columns, layers or another
    /// transform, or destroyed; nothing if the set still holds for all.
    [[nodiscard]] std::optional<std::uint32_t> outdatedSprite() const;
    [[nodiscard]] std::uint32_t size() const;
    /// Bytes of GL memory held, without the sprites.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit SpriteSet(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
