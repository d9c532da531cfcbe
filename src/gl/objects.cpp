#include "gl/objects.hpp"

#include "gl/device_state.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <string>

namespace lamina::gl {
namespace detail {
namespace {

GLenum identifier(ObjectKind kind) {
    switch (kind) {
    case ObjectKind::Buffer:
        return GL_BUFFER;
    case ObjectKind::Texture:
        return GL_TEXTURE;
    case ObjectKind::Framebuffer:
        return GL_FRAMEBUFFER;
    case ObjectKind::VertexArray:
        return GL_VERTEX_ARRAY;
    case ObjectKind::Program:
        return GL_PROGRAM;
    case ObjectKind::Query:
        return GL_QUERY;
    case ObjectKind::TransformFeedback:
        return GL_TRANSFORM_FEEDBACK;
    }
    return GL_NONE;
}

} // namespace

GLuint createObject(DeviceState& device, ObjectKind kind, GLenum target) {
    GLuint id = 0;
    switch (kind) {
    case ObjectKind::Buffer:
        device.gl.CreateBuffers(1, &id);
        break;
    case ObjectKind::Texture:
        device.gl.CreateTextures(target, 1, &id);
        break;
    case ObjectKind::Framebuffer:
        device.gl.CreateFramebuffers(1, &id);
        break;
    case ObjectKind::VertexArray:
        device.gl.CreateVertexArrays(1, &id);
        break;
    case ObjectKind::Program:
        id = device.gl.CreateProgram();
        break;
    case ObjectKind::Query:
        device.gl.CreateQueries(target, 1, &id);
        break;
    case ObjectKind::TransformFeedback:
        device.gl.CreateTransformFeedbacks(1, &id);
        break;
    }
    return id;
}

void destroyObject(DeviceState& device, ObjectKind kind, GLuint id, std::uint64_t bytes) {
    device.allocatedBytes -= bytes;
    switch (kind) {
    case ObjectKind::Buffer:
        device.gl.DeleteBuffers(1, &id);
        break;
    case ObjectKind::Texture:
        device.gl.DeleteTextures(1, &id);
        break;
    case ObjectKind::Framebuffer:
        device.gl.DeleteFramebuffers(1, &id);
        break;
    case ObjectKind::VertexArray:
        device.gl.DeleteVertexArrays(1, &id);
        break;
    case ObjectKind::Program:
        device.gl.DeleteProgram(id);
        break;
    case ObjectKind::Query:
        device.gl.DeleteQueries(1, &id);
        break;
    case ObjectKind::TransformFeedback:
        device.gl.DeleteTransformFeedbacks(1, &id);
        break;
    }
}

void labelObject(DeviceState& device, ObjectKind kind, GLuint id, std::string_view label) {
    device.gl.ObjectLabel(identifier(kind), id, static_cast<GLsizei>(label.size()), label.data());
}

} // namespace detail

namespace {

std::string mebibytes(std::uint64_t bytes) {
    constexpr std::uint64_t kMebibyte = 1u << 20;
    if (bytes < kMebibyte)
        return std::to_string(bytes) + " bytes";
    return std::to_string((bytes + kMebibyte - 1) / kMebibyte) + " MiB";
}

Result<void> checkBudget(const DeviceState& device, std::uint64_t bytes,
                         std::string_view operation) {
    const std::uint64_t budget = device.desc.memoryBudgetBytes;
    if (budget != 0 && (bytes > budget || device.allocatedBytes > budget - bytes))
        return Error{
            ErrorCode::OutOfMemory,
            std::string(operation) + ": needs " + mebibytes(bytes) + ", the memory budget of " +
                mebibytes(budget) + " has " +
                mebibytes(budget > device.allocatedBytes ? budget - device.allocatedBytes : 0) +
                " left; raise the budget or use fewer voxels"};
    return {};
}

/// Runs an allocation and tells whether the device had the memory. Errors the host left pending
/// would be mistaken for ours, so they are taken off the queue and reported first.
template<class Allocate>
Result<void> allocate(DeviceState& device, std::uint64_t bytes, std::string_view operation,
                      Allocate&& run) {
    if (const GLenum pending = device.gl.GetError(); pending != GL_NO_ERROR)
        device.say(MessageSeverity::Warning, std::string(operation) + ": the host left GL error " +
                                                 std::to_string(pending) +
                                                 " pending; it is cleared");
    run();
    if (const GLenum error = device.gl.GetError(); error != GL_NO_ERROR)
        return Error{ErrorCode::OutOfMemory,
                     std::string(operation) + ": the device could not give " + mebibytes(bytes) +
                         " (GL error " + std::to_string(error) + "); use fewer voxels"};
    device.allocatedBytes += bytes;
    return {};
}

} // namespace

Result<Buffer> createBuffer(const std::shared_ptr<DeviceState>& device, std::uint64_t bytes,
                            const void* data, GLbitfield storageFlags, std::string_view operation,
                            std::string_view label) {
    if (auto current = checkContext(*device, operation); !current)
        return current.error();
    if (auto fits = checkBudget(*device, bytes, operation); !fits)
        return fits.error();
    Buffer buffer = Buffer::create(device, label);
    const auto stored = allocate(*device, bytes, operation, [&] {
        device->gl.NamedBufferStorage(buffer.id(), static_cast<GLsizeiptr>(bytes), data,
                                      storageFlags);
    });
    if (!stored)
        return stored.error();
    buffer.setBytes(bytes);
    return buffer;
}

namespace {

/// Size of a texture, and the most of it that the device can do, in the error's words.
struct TextureShape {
    GLenum target = GL_TEXTURE_2D;
    glm::uvec3 size{1};
    glm::uvec3 limit{1};
    std::uint32_t levels = 1;
    std::string description; ///< Of the size.
    std::string limitDescription;
};

Result<Texture> createTexture(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                              std::uint32_t bytesPerTexel, const TextureShape& shape,
                              std::string_view operation, std::string_view label) {
    const glm::uvec3 size = shape.size;
    if (size.x > shape.limit.x || size.y > shape.limit.y || size.z > shape.limit.z)
        return Error{ErrorCode::DeviceLimit, std::string(operation) + ": needs a " +
                                                 shape.description + ", the device's limit is " +
                                                 shape.limitDescription + "; use a smaller grid"};
    std::uint64_t bytes = 0;
    for (std::uint32_t level = 0; level < shape.levels; ++level)
        bytes += std::uint64_t{bytesPerTexel} * std::max(size.x >> level, 1u) *
                 std::max(size.y >> level, 1u) * size.z;
    if (auto current = checkContext(*device, operation); !current)
        return current.error();
    if (auto fits = checkBudget(*device, bytes, operation); !fits)
        return fits.error();
    Texture texture = Texture::create(device, label, shape.target);
    const auto width = static_cast<GLsizei>(size.x);
    const auto height = static_cast<GLsizei>(size.y);
    const auto stored = allocate(*device, bytes, operation, [&] {
        const auto levels = static_cast<GLsizei>(shape.levels);
        if (shape.target == GL_TEXTURE_2D || shape.target == GL_TEXTURE_CUBE_MAP)
            device->gl.TextureStorage2D(texture.id(), levels, internalFormat, width, height);
        else
            device->gl.TextureStorage3D(texture.id(), levels, internalFormat, width, height,
                                        static_cast<GLsizei>(size.z));
    });
    if (!stored)
        return stored.error();
    texture.setBytes(bytes);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        device->gl.TextureParameteri(texture.id(), filter, GL_NEAREST);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        device->gl.TextureParameteri(texture.id(), axis, GL_CLAMP_TO_EDGE);
    return texture;
}

std::string product(std::initializer_list<std::uint32_t> factors) {
    std::string text;
    for (const std::uint32_t factor : factors)
        text += (text.empty() ? "" : " x ") + std::to_string(factor);
    return text;
}

} // namespace

Result<Texture> createTexture2d(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                                std::uint32_t bytesPerTexel, std::uint32_t width,
                                std::uint32_t height, std::string_view operation,
                                std::string_view label) {
    const std::uint32_t limit = device->limits.maxTextureSize;
    return createTexture(device, internalFormat, bytesPerTexel,
                         {GL_TEXTURE_2D,
                          {width, height, 1},
                          {limit, limit, 1},
                          1,
                          "texture of " + product({width, height}),
                          product({limit, limit})},
                         operation, label);
}

namespace {

Result<Texture> createPyramid(const std::shared_ptr<DeviceState>& device, GLenum target,
                              GLenum internalFormat, std::uint32_t bytesPerTexel,
                              const glm::uvec3& size, std::string_view operation,
                              std::string_view label) {
    const std::uint32_t limit = device->limits.maxTextureSize;
    auto texture =
        createTexture(device, internalFormat, bytesPerTexel,
                      {target,
                       size,
                       {limit, limit, size.z},
                       static_cast<std::uint32_t>(std::bit_width(std::max(size.x, size.y))),
                       (target == GL_TEXTURE_CUBE_MAP ? "cube map of " : "texture of ") +
                           product({size.x, size.y}),
                       product({limit, limit})},
                      operation, label);
    if (texture) {
        device->gl.TextureParameteri(texture->id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        device->gl.TextureParameteri(texture->id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
    return texture;
}

} // namespace

Result<Texture> createMippedTexture2d(const std::shared_ptr<DeviceState>& device,
                                      GLenum internalFormat, std::uint32_t bytesPerTexel,
                                      std::uint32_t width, std::uint32_t height,
                                      std::string_view operation, std::string_view label) {
    return createPyramid(device, GL_TEXTURE_2D, internalFormat, bytesPerTexel, {width, height, 1},
                         operation, label);
}

Result<Texture> createMippedCubeMap(const std::shared_ptr<DeviceState>& device,
                                    GLenum internalFormat, std::uint32_t bytesPerTexel,
                                    std::uint32_t size, std::string_view operation,
                                    std::string_view label) {
    constexpr std::uint32_t kFaces = 6;
    return createPyramid(device, GL_TEXTURE_CUBE_MAP, internalFormat, bytesPerTexel,
                         {size, size, kFaces}, operation, label);
}

Result<Texture> createTextureArray(const std::shared_ptr<DeviceState>& device,
                                   GLenum internalFormat, std::uint32_t bytesPerTexel,
                                   std::uint32_t width, std::uint32_t height, std::uint32_t layers,
                                   std::string_view operation, std::string_view label) {
    const std::uint32_t limit = device->limits.maxTextureSize;
    const std::uint32_t layerLimit = device->limits.maxArrayTextureLayers;
    return createTexture(device, internalFormat, bytesPerTexel,
                         {GL_TEXTURE_2D_ARRAY,
                          {width, height, layers},
                          {limit, limit, layerLimit},
                          1,
                          "texture of " + product({width, height, layers}) + " layers",
                          product({limit, limit, layerLimit})},
                         operation, label);
}

Result<Texture> createTexture3d(const std::shared_ptr<DeviceState>& device, GLenum internalFormat,
                                std::uint32_t bytesPerTexel, std::uint32_t width,
                                std::uint32_t height, std::uint32_t depth,
                                std::string_view operation, std::string_view label) {
    GLint limit = 0;
    device->gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
    const auto most = static_cast<std::uint32_t>(limit);
    return createTexture(device, internalFormat, bytesPerTexel,
                         {GL_TEXTURE_3D,
                          {width, height, depth},
                          glm::uvec3(most),
                          1,
                          "3D texture of " + product({width, height, depth}),
                          std::to_string(most) + " each way"},
                         operation, label);
}

} // namespace lamina::gl
