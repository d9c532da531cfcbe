#include "voxelize/volume_mesh.hpp"

#include "voxelize/mesh_view.hpp"
#include "voxelize/volume_constants.hpp"

#include <array>
#include <string>

namespace lamina {
namespace {

constexpr GLuint kNormalBinding = 1;
constexpr GLuint kColorBinding = 2;
/// In the buffer of default attributes: white, then a zero normal.
constexpr std::array<float, 7> kDefaults = {1.0f, 1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f};
constexpr GLintptr kDefaultNormalOffset = 4 * sizeof(float);

Result<void> checkStream(const gl::DeviceState& device, const VertexStream& stream,
                         std::uint32_t vertexCount, std::uint64_t valueBytes,
                         const std::string& name) {
    const auto invalid = [&](std::string text) {
        return Error{ErrorCode::InvalidArgument, name + ": " + std::move(text)};
    };
    if (stream.buffer == 0 || vertexCount == 0)
        return {};
    if (!device.gl.IsBuffer(stream.buffer))
        return invalid("expected buffer to name a GL buffer, found " +
                       std::to_string(stream.buffer));
    if (stream.strideBytes == 0 || stream.strideBytes % 4 != 0 || stream.offsetBytes % 4 != 0)
        return invalid("expected a stride above 0 and stride and offset in multiples of 4 bytes, "
                       "found stride " +
                       std::to_string(stream.strideBytes) + ", offset " +
                       std::to_string(stream.offsetBytes));
    if (stream.strideBytes > device.limits.maxVertexAttribStride)
        return Error{ErrorCode::DeviceLimit,
                     name + ": stride " + std::to_string(stream.strideBytes) +
                         " bytes, the device's limit is " +
                         std::to_string(device.limits.maxVertexAttribStride) +
                         "; repack the vertices"};
    GLint64 found = 0;
    device.gl.GetNamedBufferParameteri64v(stream.buffer, GL_BUFFER_SIZE, &found);
    const std::uint64_t needed = endOfRange(
        stream.offsetBytes, std::uint64_t{vertexCount - 1} * stream.strideBytes + valueBytes);
    if (needed > static_cast<std::uint64_t>(found))
        return invalid("expected a buffer of " + std::to_string(needed) + " bytes for " +
                       std::to_string(vertexCount) + " vertices, found " + std::to_string(found));
    return {};
}

} // namespace

Result<void> checkMeshAttributes(const gl::DeviceState& device, const MeshView& view,
                                 std::size_t index) {
    const std::string source = "voxelize: source " + std::to_string(index) + ": ";
    if (auto valid = checkStream(device, view.normals, view.vertexCount, 3 * sizeof(float),
                                 source + "normals");
        !valid)
        return valid;
    const std::uint64_t colorBytes =
        view.colorFormat == VertexColorFormat::Float ? 4 * sizeof(float) : 4;
    return checkStream(device, view.colors, view.vertexCount, colorBytes, source + "colours");
}

gl::VertexArray createAttributeArray(const std::shared_ptr<gl::DeviceState>& device) {
    auto vertexArray = gl::VertexArray::create(device, "lamina mesh view with attributes");
    const GladGLContext& gl = device->gl;
    const GLuint id = vertexArray.id();
    constexpr std::array<GLuint, 3> kAttributes = {LAMINA_ATTRIBUTE_POSITION,
                                                   LAMINA_ATTRIBUTE_NORMAL, LAMINA_ATTRIBUTE_COLOR};
    for (GLuint binding = 0; binding < kAttributes.size(); ++binding) {
        gl.EnableVertexArrayAttrib(id, kAttributes[binding]);
        gl.VertexArrayAttribFormat(id, kAttributes[binding], binding == kColorBinding ? 4 : 3,
                                   GL_FLOAT, GL_FALSE, 0);
        gl.VertexArrayAttribBinding(id, kAttributes[binding], binding);
    }
    return vertexArray;
}

void bindMeshAttributes(gl::DeviceState& device, GLuint vertexArray, GLuint defaults,
                        const MeshView& view) {
    const GladGLContext& gl = device.gl;
    // A stride of 0 gives every vertex the same value.
    const auto bindStream = [&](GLuint binding, const VertexStream& stream, GLintptr fallback) {
        const bool hasStream = stream.buffer != 0;
        gl.VertexArrayVertexBuffer(vertexArray, binding, hasStream ? stream.buffer : defaults,
                                   hasStream ? static_cast<GLintptr>(stream.offsetBytes) : fallback,
                                   hasStream ? static_cast<GLsizei>(stream.strideBytes) : 0);
    };
    bindStream(kNormalBinding, view.normals, kDefaultNormalOffset);
    bindStream(kColorBinding, view.colors, 0);
    const bool areBytes = view.colors.buffer != 0 && view.colorFormat == VertexColorFormat::UNorm8;
    gl.VertexArrayAttribFormat(vertexArray, LAMINA_ATTRIBUTE_COLOR, 4,
                               areBytes ? GL_UNSIGNED_BYTE : GL_FLOAT,
                               areBytes ? GL_TRUE : GL_FALSE, 0);
}

Result<gl::Buffer> createDefaultAttributes(const std::shared_ptr<gl::DeviceState>& device) {
    return gl::createBuffer(device, sizeof kDefaults, kDefaults.data(), 0, "volume",
                            "lamina default attributes");
}

} // namespace lamina
