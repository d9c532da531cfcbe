#include "voxelize/overlap_source.hpp"

#include "voxelize/mesh_view.hpp"
#include "voxelize/overlap_grid.hpp"
#include "voxelize/volume_draw.hpp"
#include "voxelize/volume_mesh.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <string>

namespace lamina {
namespace {

struct Range {
    std::uint64_t begin = 0; ///< Bytes.
    std::uint64_t end = 0;   ///< Bytes.

    [[nodiscard]] std::uint64_t alignedBegin(std::uint64_t alignment) const {
        return begin / alignment * alignment;
    }
};

/// Of a position and of a normal.
constexpr std::uint64_t kVectorBytes = 3 * sizeof(float);

std::uint64_t indexBytes(IndexType type) {
    return type == IndexType::UInt16 ? 2 : 4;
}

bool isIndexed(const MeshView& view) {
    return view.indexType != IndexType::None;
}

std::uint64_t chunkVertices(const MeshView& view, std::uint64_t count) {
    return isIndexed(view) ? view.vertexCount : count * 3;
}

/// Bytes of a stream of the view that a chunk of its triangles reads.
Range streamRange(const MeshView& view, const VertexStream& stream, std::uint64_t valueBytes,
                  std::uint64_t firstTriangle, std::uint64_t count) {
    const std::uint64_t first = isIndexed(view) ? 0 : firstTriangle * 3;
    const std::uint64_t begin = stream.offsetBytes + first * stream.strideBytes;
    return {begin, begin + (chunkVertices(view, count) - 1) * stream.strideBytes + valueBytes};
}

Range vertexRange(const MeshView& view, std::uint64_t firstTriangle, std::uint64_t count) {
    return streamRange(view, {view.vertexBuffer, view.positionOffsetBytes, view.vertexStrideBytes},
                       kVectorBytes, firstTriangle, count);
}

/// Of one colour of the view, and of the material id behind it.
std::uint64_t colorBytes(const MeshView& view, bool hasMaterial) {
    return (view.colorFormat == VertexColorFormat::Float ? 4 * sizeof(float) : 4) +
           (hasMaterial ? sizeof(std::uint32_t) : 0);
}

/// Bytes of the index buffer that a chunk reads, in whole words.
Range indexRange(const MeshView& view, std::uint64_t firstTriangle, std::uint64_t count) {
    const std::uint64_t size = indexBytes(view.indexType);
    const std::uint64_t begin = view.indexOffsetBytes + firstTriangle * 3 * size;
    return {begin / 4 * 4, (begin + count * 3 * size + 3) / 4 * 4};
}

/// Can shaders read the view's buffers as storage? They see whole words, and no more than the
/// device's limit.
bool isReadable(const gl::DeviceState& device, const MeshView& view, CaptureContent content) {
    const std::uint64_t limit =
        device.limits.maxStorageBlockBytes - device.limits.storageBufferOffsetAlignment;
    const std::uint64_t count =
        std::min<std::uint64_t>(triangleCount(view), LAMINA_OVERLAP_CHUNK_TRIANGLES);
    const auto fits = [limit](const Range& range) { return range.end - range.begin <= limit; };
    if (!fits(vertexRange(view, 0, count)))
        return false;
    if (content == CaptureContent::Surfaces &&
        ((view.normals.buffer != 0 &&
          !fits(streamRange(view, view.normals, kVectorBytes, 0, count))) ||
         (view.colors.buffer != 0 &&
          !fits(streamRange(view, view.colors, colorBytes(view, false), 0, count)))))
        return false;
    if (!isIndexed(view))
        return true;
    GLint64 found = 0;
    device.gl.GetNamedBufferParameteri64v(view.indexBuffer, GL_BUFFER_SIZE, &found);
    return indexRange(view, 0, triangleCount(view)).end <= static_cast<std::uint64_t>(found);
}

MeshView viewOf(const CapturedTriangles& captured) {
    MeshView view;
    view.vertexBuffer = captured.buffer;
    view.vertexCount = static_cast<std::uint32_t>(captured.capacity * 3);
    if (captured.content == CaptureContent::Surfaces) {
        constexpr std::uint32_t kStride = LAMINA_CAPTURE_SURFACE_BYTES;
        view.vertexStrideBytes = kStride;
        view.normals = {captured.buffer, LAMINA_CAPTURE_NORMAL_OFFSET, kStride};
        view.colors = {captured.buffer, LAMINA_CAPTURE_COLOR_OFFSET, kStride};
    }
    return view;
}

void bindRange(const gl::DeviceState& device, GLuint binding, GLuint buffer, const Range& range) {
    const std::uint64_t begin = range.alignedBegin(device.limits.storageBufferOffsetAlignment);
    const auto offset = static_cast<GLintptr>(begin);
    const auto size = static_cast<GLsizeiptr>(range.end - begin);
    device.gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, binding, 1, &buffer, &offset, &size);
}

} // namespace

void OverlapSource::write(std::uint64_t firstTriangle, std::uint64_t count, std::uint64_t alignment,
                          shared::LaminaOverlapConstants& block) const {
    const glm::dmat4 rows = glm::transpose(localToGrid);
    for (int row = 0; row < 3; ++row)
        block.localToGrid[row] = rows[row];
    const Range vertices = vertexRange(view, firstTriangle, count);
    block.vertices = {(vertices.begin - vertices.alignedBegin(alignment)) / 4,
                      view.vertexStrideBytes / 4, chunkVertices(view, count), 0};
    block.source = {count, 0, LAMINA_INDEX_NONE, 0};
    if (content == CaptureContent::Surfaces)
        writeSurface(firstTriangle, count, alignment, block);
    if (!isIndexed(view))
        return;
    const std::uint64_t size = indexBytes(view.indexType);
    const std::uint64_t begin = view.indexOffsetBytes + firstTriangle * 3 * size;
    block.source.y = static_cast<std::uint32_t>(
        (begin - indexRange(view, firstTriangle, count).alignedBegin(alignment)) / size);
    block.source.z =
        view.indexType == IndexType::UInt16 ? LAMINA_INDEX_UINT16 : LAMINA_INDEX_UINT32;
}

void OverlapSource::writeSurface(std::uint64_t firstTriangle, std::uint64_t count,
                                 std::uint64_t alignment,
                                 shared::LaminaOverlapConstants& block) const {
    const auto place = [&](const VertexStream& stream) {
        if (stream.buffer == 0)
            return glm::uvec4(0);
        const Range range = streamRange(view, stream, 4, firstTriangle, count);
        return glm::uvec4((range.begin - range.alignedBegin(alignment)) / 4, stream.strideBytes / 4,
                          0, 0);
    };
    block.normals = place(view.normals);
    block.colors = place(view.colors);
    if (view.colors.buffer != 0)
        block.colors.z = view.colorFormat == VertexColorFormat::Float ? LAMINA_COLORS_FLOAT
                                                                      : LAMINA_COLORS_UNORM8;
    block.materials = {view.materialId, 0, 0, 0};
    if (hasVertexMaterials)
        block.materials = {block.colors.x + 4, block.colors.y, 0, 0};
    const glm::dmat3 rows = glm::transpose(normalToWorld);
    for (int row = 0; row < 3; ++row)
        block.normalToWorld[row] = glm::vec4(glm::vec3(rows[row]), 0.0f);
}

void OverlapSource::bind(const gl::DeviceState& device, std::uint64_t firstTriangle,
                         std::uint64_t count) const {
    bindRange(device, LAMINA_OVERLAP_VERTEX_BINDING, view.vertexBuffer,
              vertexRange(view, firstTriangle, count));
    if (isIndexed(view))
        bindRange(device, LAMINA_OVERLAP_INDEX_BINDING, view.indexBuffer,
                  indexRange(view, firstTriangle, count));
    if (content == CaptureContent::Positions)
        return;
    if (view.normals.buffer != 0)
        bindRange(device, LAMINA_OVERLAP_NORMALS_BINDING, view.normals.buffer,
                  streamRange(view, view.normals, kVectorBytes, firstTriangle, count));
    if (view.colors.buffer != 0)
        bindRange(device, LAMINA_OVERLAP_COLORS_BINDING, view.colors.buffer,
                  streamRange(view, view.colors, colorBytes(view, hasVertexMaterials),
                              firstTriangle, count));
}

Result<std::vector<OverlapSource>> OverlapSources::prepare(std::span<const GeometrySource> sources,
                                                           const GridTransform& transform,
                                                           VoxelizeStats& stats) {
    // Every error of a source comes before the first callback runs.
    std::vector<GLuint> programs(sources.size());
    std::vector<OverlapSource> prepared(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        OverlapSource& source = prepared[i];
        source.localToGrid = overlapWorldToGrid(transform);
        source.content = mContent;
        Result<GLuint> program = GLuint{0};
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*mDevice, *view, i); !valid)
                return valid.error();
            if (mContent == CaptureContent::Surfaces)
                if (auto valid = checkMeshAttributes(*mDevice, *view, i); !valid)
                    return valid.error();
            source.localToGrid = source.localToGrid * glm::dmat4(view->model);
            source.normalToWorld = normalMatrix(glm::dmat4(view->model));
            source.view = *view;
            source.triangles = triangleCount(*view);
            stats.meshTriangles += source.triangles;
            if (source.triangles > 0 && !isReadable(*mDevice, *view, mContent))
                program = mCapture.meshProgram();
        } else {
            const auto& draw = std::get<DrawSource>(sources[i]);
            if (auto valid = checkDrawSource(draw, i); !valid)
                return valid.error();
            program = mCapture.program(draw);
        }
        if (!program)
            return program.error();
        programs[i] = *program;
    }
    if (std::ranges::any_of(programs, [](GLuint program) { return program != 0; }))
        if (auto free = mCapture.checkHost(); !free)
            return free.error();
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (programs[i] == 0)
            continue;
        const auto* view = std::get_if<MeshView>(&sources[i]);
        auto captured = view ? mCapture.capture(i, *view, programs[i])
                             : mCapture.capture(i, std::get<DrawSource>(sources[i]), programs[i]);
        if (!captured)
            return captured.error();
        prepared[i].view = viewOf(*captured);
        if (view)
            prepared[i].view.materialId = view->materialId;
        prepared[i].hasVertexMaterials = mContent == CaptureContent::Surfaces && !view;
        prepared[i].triangles = captured->capacity;
    }
    return prepared;
}

} // namespace lamina
