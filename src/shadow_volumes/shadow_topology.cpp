#include "core/check_enumeration.hpp"
#include "shadow_volumes/silhouette_edges.hpp"
#include "shadow_volumes/topology_impl.hpp"
#include "voxelize/mesh_view.hpp"
#include "voxelize/triangle_capture.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

namespace lamina {
namespace {

constexpr const char* kOperation = "shadow topology";

std::vector<glm::vec3> readPositions(const GladGLContext& gl, const MeshView& view) {
    if (view.vertexCount == 0)
        return {};
    const std::size_t stride = view.vertexStrideBytes;
    std::vector<std::byte> bytes((view.vertexCount - 1) * stride + sizeof(glm::vec3));
    gl.GetNamedBufferSubData(view.vertexBuffer, static_cast<GLintptr>(view.positionOffsetBytes),
                             static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    std::vector<glm::vec3> positions(view.vertexCount);
    for (std::size_t i = 0; i < positions.size(); ++i)
        std::memcpy(&positions[i], bytes.data() + i * stride, sizeof(glm::vec3));
    return positions;
}

template<class Index>
std::vector<std::uint32_t> readIndexBuffer(const GladGLContext& gl, const MeshView& view) {
    std::vector<Index> indices(view.indexCount);
    if (!indices.empty())
        gl.GetNamedBufferSubData(view.indexBuffer, static_cast<GLintptr>(view.indexOffsetBytes),
                                 static_cast<GLsizeiptr>(indices.size() * sizeof(Index)),
                                 indices.data());
    return {indices.begin(), indices.end()};
}

std::vector<std::uint32_t> readIndices(const GladGLContext& gl, const MeshView& view) {
    if (view.indexType == IndexType::UInt16)
        return readIndexBuffer<std::uint16_t>(gl, view);
    if (view.indexType == IndexType::UInt32)
        return readIndexBuffer<std::uint32_t>(gl, view);
    std::vector<std::uint32_t> indices(view.vertexCount / 3 * 3);
    std::iota(indices.begin(), indices.end(), 0u);
    return indices;
}

Result<MeshView> captured(const DrawSource& source, TriangleCapture& capture) {
    if (auto valid = checkDrawSource(source, 0, "shadow topology: source"); !valid)
        return valid.error();
    auto program = capture.program(source);
    if (!program)
        return program.error();
    if (auto free = capture.checkHost(); !free)
        return free.error();
    auto triangles = capture.capture(0, source, *program);
    if (!triangles)
        return triangles.error();
    MeshView view;
    view.vertexBuffer = triangles->buffer;
    view.vertexCount = static_cast<std::uint32_t>(triangles->capacity * 3);
    return view;
}

template<class Item>
Result<gl::Buffer> upload(const std::shared_ptr<gl::DeviceState>& device,
                          const std::vector<Item>& items, std::string_view label) {
    // A buffer of no bytes is an error to GL; a mesh of no triangles is none to us.
    static constexpr Item kNothing{};
    return gl::createBuffer(device, std::max<std::size_t>(items.size(), 1) * sizeof(Item),
                            items.empty() ? &kNothing : items.data(), 0, kOperation, label);
}

} // namespace

Result<ShadowTopology> ShadowTopology::create(const Device& device, const GeometrySource& source,
                                              CasterSurface surface) {
    if (auto valid = checkEnumeration(kOperation, "CasterSurface", surface, CasterSurface::Sheet);
        !valid)
        return valid.error();
    const std::shared_ptr<gl::DeviceState>& state = device.state();
    const gl::DebugGroup group(*state, "lamina: shadow topology");
    TriangleCapture capture(state, CaptureContent::Positions);
    MeshView view;
    if (const auto* mesh = std::get_if<MeshView>(&source)) {
        if (auto valid = checkMeshView(*state, *mesh, 0, "shadow topology: source"); !valid)
            return valid.error();
        view = *mesh;
    } else {
        auto drawn = captured(std::get<DrawSource>(source), capture);
        if (!drawn)
            return drawn.error();
        view = *drawn;
    }
    const std::vector<glm::vec3> positions = readPositions(state->gl, view);
    const std::vector<std::uint32_t> indices = readIndices(state->gl, view);
    const auto bad = std::ranges::find_if(
        indices, [&](std::uint32_t index) { return index >= positions.size(); });
    if (bad != indices.end())
        return Error{ErrorCode::InvalidMesh,
                     std::string(kOperation) + ": expected indices below vertexCount " +
                         std::to_string(positions.size()) + ", found " + std::to_string(*bad) +
                         " at index " + std::to_string(bad - indices.begin())};
    const SilhouetteMesh mesh = findSilhouetteMesh(positions, indices);
    // What the count of a draw, a signed integer, can say.
    constexpr std::size_t kMostEdges = std::numeric_limits<GLsizei>::max() / 4;
    if (mesh.edges.size() > kMostEdges || mesh.triangles.size() > kMostEdges)
        return Error{ErrorCode::DeviceLimit, std::string(kOperation) + ": expected at most " +
                                                 std::to_string(kMostEdges) + " edges, found " +
                                                 std::to_string(mesh.edges.size()) +
                                                 "; split the mesh into several casters"};

    auto triangles = upload(state, mesh.triangles, "lamina caster triangles");
    if (!triangles)
        return triangles.error();
    auto edges = upload(state, mesh.edges, "lamina caster edges");
    if (!edges)
        return edges.error();
    auto impl = std::make_unique<Impl>();
    impl->triangles = std::move(*triangles);
    impl->edges = std::move(*edges);
    impl->triangleCount = static_cast<std::uint32_t>(mesh.triangles.size());
    impl->edgeCount = static_cast<std::uint32_t>(mesh.edges.size());
    for (const glm::uvec3& triangle : mesh.triangles)
        impl->vertexCount =
            std::max({impl->vertexCount, triangle.x + 1, triangle.y + 1, triangle.z + 1});
    impl->openEdgeCount = mesh.openEdgeCount;
    impl->surface = surface;
    if (surface == CasterSurface::Automatic)
        impl->surface = mesh.isClosed() ? CasterSurface::Closed : CasterSurface::Sheet;
    return ShadowTopology(std::move(impl));
}

ShadowTopology::ShadowTopology(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
ShadowTopology::ShadowTopology(ShadowTopology&&) noexcept = default;
ShadowTopology& ShadowTopology::operator=(ShadowTopology&&) noexcept = default;
ShadowTopology::~ShadowTopology() = default;

bool ShadowTopology::isClosed() const {
    return mImpl->triangleCount > 0 && mImpl->openEdgeCount == 0;
}
CasterSurface ShadowTopology::surface() const {
    return mImpl->surface;
}
std::uint32_t ShadowTopology::triangleCount() const {
    return mImpl->triangleCount;
}
std::uint32_t ShadowTopology::edgeCount() const {
    return mImpl->edgeCount;
}
std::uint32_t ShadowTopology::openEdgeCount() const {
    return mImpl->openEdgeCount;
}
std::uint32_t ShadowTopology::vertexCount() const {
    return mImpl->vertexCount;
}
std::uint64_t ShadowTopology::gpuBytes() const {
    return mImpl->triangles.bytes() + mImpl->edges.bytes();
}

} // namespace lamina
