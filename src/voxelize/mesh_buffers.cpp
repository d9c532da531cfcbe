#include "gl/device_state.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <span>

namespace lamina {

struct MeshBuffers::Impl {
    gl::Buffer vertices;
    gl::Buffer indices;
    gl::Buffer normals;
    gl::Buffer colors;
    std::uint32_t vertexCount = 0;
    std::uint32_t indexCount = 0;
};

MeshBuffers::MeshBuffers(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
MeshBuffers::MeshBuffers(MeshBuffers&&) noexcept = default;
MeshBuffers& MeshBuffers::operator=(MeshBuffers&&) noexcept = default;
MeshBuffers::~MeshBuffers() = default;

Result<MeshBuffers> MeshBuffers::upload(const Device& device, const TriangleMesh& mesh) {
    if (auto valid = validate(mesh); !valid)
        return valid.error();
    // Counts are 32-bit in GL draws.
    constexpr std::size_t kMaxTriangles = 0xffffffffu / 3;
    if (mesh.triangles.size() > kMaxTriangles)
        return Error{ErrorCode::DeviceLimit,
                     "mesh upload: expected at most " + std::to_string(kMaxTriangles) +
                         " triangles, found " + std::to_string(mesh.triangles.size()) +
                         "; upload it in parts"};
    auto impl = std::make_unique<Impl>();
    auto vertices = gl::createBuffer(device.state(), mesh.positions.size() * sizeof(glm::vec3),
                                     mesh.positions.data(), 0, "mesh upload", "lamina positions");
    if (!vertices)
        return vertices.error();
    auto indices = gl::createBuffer(device.state(), mesh.triangles.size() * sizeof(glm::uvec3),
                                    mesh.triangles.data(), 0, "mesh upload", "lamina indices");
    if (!indices)
        return indices.error();
    const auto uploadStream = [&](const auto& values, gl::Buffer& buffer, const char* label) {
        if (values.empty())
            return Result<void>();
        auto stored = gl::createBuffer(device.state(), std::span(values).size_bytes(),
                                       values.data(), 0, "mesh upload", label);
        if (!stored)
            return Result<void>(stored.error());
        buffer = std::move(*stored);
        return Result<void>();
    };
    if (auto stored = uploadStream(mesh.normals, impl->normals, "lamina normals"); !stored)
        return stored.error();
    if (auto stored = uploadStream(mesh.colors, impl->colors, "lamina colors"); !stored)
        return stored.error();
    impl->vertices = std::move(*vertices);
    impl->indices = std::move(*indices);
    impl->vertexCount = static_cast<std::uint32_t>(mesh.positions.size());
    impl->indexCount = static_cast<std::uint32_t>(mesh.triangles.size() * 3);
    return MeshBuffers(std::move(impl));
}

MeshView MeshBuffers::view(const glm::mat4& model) const {
    MeshView view;
    view.vertexBuffer = mImpl->vertices.id();
    view.vertexCount = mImpl->vertexCount;
    view.indexBuffer = mImpl->indices.id();
    view.indexType = IndexType::UInt32;
    view.indexCount = mImpl->indexCount;
    view.model = model;
    view.normals = {mImpl->normals.id(), 0, sizeof(glm::vec3)};
    view.colors = {mImpl->colors.id(), 0, sizeof(glm::vec4)};
    return view;
}

std::uint64_t MeshBuffers::gpuBytes() const {
    return mImpl->vertices.bytes() + mImpl->indices.bytes() + mImpl->normals.bytes() +
           mImpl->colors.bytes();
}

} // namespace lamina
