#pragma once

#include "gl/glad.hpp"

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

namespace lamina::gl {

struct DeviceState;

enum class ObjectKind : std::uint8_t {
    Buffer,
    Texture,
    Framebuffer,
    VertexArray,
    Program,
    Query,
    TransformFeedback
};
enum class Ownership : std::uint8_t { Owned, Borrowed };

namespace detail {
LAMINA_API GLuint createObject(DeviceState& device, ObjectKind kind, GLenum textureTarget);
LAMINA_API void destroyObject(DeviceState& device, ObjectKind kind, GLuint id, std::uint64_t bytes);
LAMINA_API void labelObject(DeviceState& device, ObjectKind kind, GLuint id,
                            std::string_view label);
} // namespace detail

/// A GL object name, deleted with its owner. Move-only; a default-constructed one holds nothing.
/// The context must be current where an owned object is destroyed.
template<ObjectKind kind>
class Object {
public:
    Object() = default;

    /// A new object, as glCreate* makes it. textureTarget: for textures alone.
    static Object create(std::shared_ptr<DeviceState> device, std::string_view label,
                         GLenum textureTarget = 0) {
        const GLuint id = detail::createObject(*device, kind, textureTarget);
        detail::labelObject(*device, kind, id, label);
        return Object(std::move(device), id, Ownership::Owned, 0);
    }
    /// An existing object; deleted with the handle if owned.
    static Object wrap(std::shared_ptr<DeviceState> device, GLuint id, Ownership ownership) {
        return Object(std::move(device), id, ownership, 0);
    }

    Object(Object&& other) noexcept
        : mDevice(std::move(other.mDevice))
        , mId(std::exchange(other.mId, 0))
        , mBytes(std::exchange(other.mBytes, 0))
        , mOwnership(other.mOwnership) {}
    Object& operator=(Object&& other) noexcept {
        if (this != &other) {
            reset();
            mDevice = std::move(other.mDevice);
            mId = std::exchange(other.mId, 0);
            mBytes = std::exchange(other.mBytes, 0);
            mOwnership = other.mOwnership;
        }
        return *this;
    }
    ~Object() { reset(); }

    [[nodiscard]] GLuint id() const { return mId; }
    explicit operator bool() const { return mId != 0; }
    /// Bytes counted against the device's memory budget.
    [[nodiscard]] std::uint64_t bytes() const { return mBytes; }
    /// Gives the name up without deleting it.
    [[nodiscard]] GLuint release() {
        mBytes = 0;
        return std::exchange(mId, 0);
    }
    /// Set by the functions that allocate storage, which have already counted the bytes.
    void setBytes(std::uint64_t bytes) { mBytes = bytes; }

private:
    Object(std::shared_ptr<DeviceState> device, GLuint id, Ownership ownership, std::uint64_t bytes)
        : mDevice(std::move(device))
        , mId(id)
        , mBytes(bytes)
        , mOwnership(ownership) {}

    void reset() {
        if (mId != 0 && mOwnership == Ownership::Owned)
            detail::destroyObject(*mDevice, kind, mId, mBytes);
        mId = 0;
        mBytes = 0;
    }

    std::shared_ptr<DeviceState> mDevice;
    GLuint mId = 0;
    std::uint64_t mBytes = 0;
    Ownership mOwnership = Ownership::Owned;
};

using Buffer = Object<ObjectKind::Buffer>;
using Texture = Object<ObjectKind::Texture>;
using Framebuffer = Object<ObjectKind::Framebuffer>;
using VertexArray = Object<ObjectKind::VertexArray>;
using Program = Object<ObjectKind::Program>;
using Query = Object<ObjectKind::Query>;
using TransformFeedback = Object<ObjectKind::TransformFeedback>;

/// A buffer with immutable storage of `bytes`, initialised from `data` unless null.
/// storageFlags: as for glNamedBufferStorage. `operation` names the caller in errors.
/// Errors: OutOfMemory (memory budget or device).
[[nodiscard]] LAMINA_API Result<Buffer>
createBuffer(const std::shared_ptr<DeviceState>& device, std::uint64_t bytes, const void* data,
             GLbitfield storageFlags, std::string_view operation, std::string_view label);

/// A one-level 2D texture with nearest filtering and clamped edges. bytesPerTexel: of
/// `internalFormat`.
/// Errors: DeviceLimit, OutOfMemory.
[[nodiscard]] LAMINA_API Result<Texture>
createTexture2d(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                std::uint32_t bytesPerTexel, std::uint32_t width, std::uint32_t height,
                std::string_view operation, std::string_view label);

/// A 2D texture with all levels, trilinear filtering and clamped edges.
/// Errors: DeviceLimit, OutOfMemory.
[[nodiscard]] LAMINA_API Result<Texture>
createMippedTexture2d(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                      std::uint32_t bytesPerTexel, std::uint32_t width, std::uint32_t height,
                      std::string_view operation, std::string_view label);

/// The same as a cube map of `size` texels a side.
[[nodiscard]] LAMINA_API Result<Texture>
createMippedCubeMap(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                    std::uint32_t bytesPerTexel, std::uint32_t size, std::string_view operation,
                    std::string_view label);

/// A one-level 2D array texture with nearest filtering. bytesPerTexel: of `internalFormat`.
/// Errors: DeviceLimit, OutOfMemory.
[[nodiscard]] LAMINA_API Result<Texture>
createTextureArray(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                   std::uint32_t bytesPerTexel, std::uint32_t width, std::uint32_t height,
                   std::uint32_t layers, std::string_view operation, std::string_view label);

/// A one-level 3D texture with nearest filtering and clamped edges. bytesPerTexel: of
/// `internalFormat`.
/// Errors: DeviceLimit, OutOfMemory.
[[nodiscard]] LAMINA_API Result<Texture>
createTexture3d(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                std::uint32_t bytesPerTexel, std::uint32_t width, std::uint32_t height,
                std::uint32_t depth, std::string_view operation, std::string_view label);

} // namespace lamina::gl
