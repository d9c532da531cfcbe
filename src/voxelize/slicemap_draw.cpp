#include "voxelize/slicemap_draw.hpp"

#include "grid/grid_constants.hpp"
#include "voxelize/mesh_view.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lamina {
namespace {

Result<GLuint> buildProgram(gl::DeviceState& device, const SlicemapStage& stage,
                            gl::ProgramStage vertexStage) {
    return gl::findOrBuildProgram(device, {"lamina slicemap",
                                           {std::move(vertexStage),
                                            {GL_GEOMETRY_SHADER, "voxelize/slicemap.geom"},
                                            {GL_FRAGMENT_SHADER, stage.fragment}},
                                           stage.defines});
}

/// 1 if a triangle that is a front (its corners turn counter-clockwise in its own space, seen from
/// the grid's camera) turns counter-clockwise in columns, else -1.
float frontTurn(const glm::dmat4& localToColumn) {
    // Depth grows away from the camera: unmirrored, (column x, column y, depth) is left-handed.
    return glm::determinant(glm::dmat3(localToColumn)) < 0.0 ? 1.0f : -1.0f;
}

} // namespace

std::string slicemapCoverage(Coverage coverage) {
    switch (coverage) {
    case Coverage::Filled:
        return "LAMINA_COVERAGE_FILLED";
    case Coverage::Conservative:
        return "LAMINA_COVERAGE_CONSERVATIVE";
    case Coverage::Solid:
        return "LAMINA_COVERAGE_SOLID";
    case Coverage::Sampled:
    case Coverage::Separating6:
        break;
    }
    return "LAMINA_COVERAGE_SAMPLED";
}

SlicemapStage slicemapRangeStage(Coverage coverage) {
    return {"voxelize/slicemap_range.frag",
            {{"LAMINA_COVERAGE", slicemapCoverage(coverage)}, {"LAMINA_SPLIT", "0"}}};
}

SlicemapDraw::SlicemapDraw(std::shared_ptr<gl::DeviceState> device)
    : mDevice(std::move(device))
    , mVertexArray(gl::VertexArray::create(mDevice, "lamina mesh view"))
    , mBlocks(gl::Buffer::create(mDevice, "lamina draw constants")) {
    const GladGLContext& gl = mDevice->gl;
    gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
    gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE,
                               0);
    gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
}

Result<GLuint> SlicemapDraw::meshProgram(const SlicemapStage& stage) const {
    return buildProgram(*mDevice, stage, {GL_VERTEX_SHADER, "voxelize/mesh.vert"});
}

Result<SlicemapSources> SlicemapDraw::prepare(std::span<const GeometrySource> sources,
                                              const GridTransform& transform,
                                              const SlicemapStage& stage) const {
    SlicemapSources prepared;
    prepared.sources = sources;
    prepared.entries.reserve(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        SlicemapSources::Entry entry;
        entry.localToColumn = transform.worldToColumn();
        Result<GLuint> built = Error{};
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*mDevice, *view, i); !valid)
                return valid.error();
            entry.localToColumn = transform.worldToColumn() * glm::dmat4(view->model);
            entry.materialId = view->materialId;
            prepared.meshTriangles += triangleCount(*view);
            built = meshProgram(stage);
        } else {
            const auto& source = std::get<DrawSource>(sources[i]);
            if (auto valid = checkDrawSource(source, i); !valid)
                return valid.error();
            built =
                buildProgram(*mDevice, stage,
                             {GL_VERTEX_SHADER, "voxelize/vertex_main.glsl", source.vertexShader});
        }
        if (!built)
            return built.error();
        entry.program = *built;
        prepared.entries.push_back(entry);
    }
    return prepared;
}

void SlicemapDraw::upload(std::span<const SlicemapPass> passes, const GridTransform& transform) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mStride = (sizeof(shared::LaminaDrawConstants) + alignment - 1) / alignment * alignment;
    mOffsets.clear();
    std::size_t blocks = 0;
    for (const SlicemapPass& pass : passes) {
        mOffsets.push_back(blocks * mStride);
        blocks += pass.sources->entries.size();
    }
    mBytes.assign(mStride * blocks, std::byte{});

    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    const double allowance = (far - near) * 0x1p-20;
    shared::LaminaDrawConstants block{};
    block.depthRange = {near, 1.0 / (far - near), near * LAMINA_EYE_CUT, transform.size().z};
    block.size = {transform.size(), gridFlags(transform)};
    // Twice the rasterizer's snapping distance, and the rounding of normalized device coordinates.
    const auto columns = static_cast<float>(std::max(transform.size().x, transform.size().y));
    block.dilation.x = 2.0f * std::ldexp(1.0f, -static_cast<int>(mDevice->limits.subpixelBits)) +
                       columns * 0x1p-22f;

    std::byte* place = mBytes.data();
    for (const SlicemapPass& pass : passes) {
        block.passDepths = {pass.nearDepth - allowance, pass.farDepth + allowance, pass.sliceCount,
                            pass.skippedWords};
        for (const SlicemapSources::Entry& source : pass.sources->entries) {
            const glm::dmat4 rows = glm::transpose(source.localToColumn);
            for (int row = 0; row < 3; ++row)
                block.localToColumn[row] = rows[row];
            block.dilation.y = frontTurn(source.localToColumn);
            block.pass = {pass.firstSlice, source.materialId, pass.gridCount, pass.split};
            std::memcpy(place, &block, sizeof block);
            place += mStride;
        }
    }
    // New storage each time: draws of the last call may still read the old.
    mDevice->gl.NamedBufferData(mBlocks.id(), static_cast<GLsizeiptr>(mBytes.size()), mBytes.data(),
                                GL_STREAM_DRAW);
}

void SlicemapDraw::drawSource(std::span<const SlicemapPass> passes, std::uint32_t index,
                              std::size_t source, gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    const SlicemapSources& sources = *passes[index].sources;
    // Multi-bind leaves the host's generic uniform buffer binding alone.
    const GLuint buffer = mBlocks.id();
    const auto offset = static_cast<GLintptr>(mOffsets[index] + source * mStride);
    constexpr GLsizeiptr kBlockBytes = sizeof(shared::LaminaDrawConstants);
    gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_DRAW_BLOCK_BINDING, 1, &buffer, &offset,
                        &kBlockBytes);
    const GLuint program = sources.entries[source].program;
    gl.UseProgram(program);
    if (const auto* view = std::get_if<MeshView>(&sources.sources[source])) {
        guard.setHostPrimitiveRestart(false);
        gl.BindVertexArray(mVertexArray.id());
        drawMeshView(*mDevice, mVertexArray.id(), *view);
    } else {
        guard.setHostPrimitiveRestart(true);
        DrawContext context;
        context.program = program;
        context.pass = index;
        context.passCount = static_cast<std::uint32_t>(passes.size());
        std::get<DrawSource>(sources.sources[source]).draw(context);
    }
}

} // namespace lamina
