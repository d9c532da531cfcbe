#include "voxelize/column_draw.hpp"

#include "gl/program_cache.hpp"
#include "grid/grid_constants.hpp"
#include "voxelize/mesh_view.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace lamina {
namespace {

Result<GLuint> buildProgram(gl::DeviceState& device, const ColumnStage& stage,
                            gl::ProgramStage vertexStage) {
    return gl::findOrBuildProgram(device, {stage.label,
                                           {std::move(vertexStage),
                                            {GL_GEOMETRY_SHADER, "voxelize/slicemap.geom"},
                                            {GL_FRAGMENT_SHADER, stage.fragmentShader}},
                                           stage.defines});
}

} // namespace

ColumnDraw::ColumnDraw(std::shared_ptr<gl::DeviceState> device)
    : mDevice(std::move(device))
    , mVertexArray(gl::VertexArray::create(mDevice, "lamina mesh view"))
    , mBlocks(gl::Buffer::create(mDevice, "lamina draw constants")) {
    const GladGLContext& gl = mDevice->gl;
    gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
    gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT, GL_FALSE,
                               0);
    gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
}

Result<GLuint> ColumnDraw::meshProgram(const ColumnStage& stage) const {
    return buildProgram(*mDevice, stage, {GL_VERTEX_SHADER, "voxelize/mesh.vert"});
}

Result<std::vector<ColumnDraw::Source>> ColumnDraw::prepare(std::span<const GeometrySource> sources,
                                                            const GridTransform& transform,
                                                            const ColumnStage& stage) const {
    std::vector<Source> prepared;
    prepared.reserve(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Source entry;
        entry.localToColumn = transform.worldToColumn();
        Result<GLuint> program = GLuint{0};
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*mDevice, *view, i); !valid)
                return valid.error();
            entry.localToColumn = transform.worldToColumn() * glm::dmat4(view->model);
            entry.materialId = view->materialId;
            program = meshProgram(stage);
        } else {
            const auto& source = std::get<DrawSource>(sources[i]);
            if (auto valid = checkDrawSource(source, i); !valid)
                return valid.error();
            program =
                buildProgram(*mDevice, stage,
                             {GL_VERTEX_SHADER, "voxelize/vertex_main.glsl", source.vertexShader});
        }
        if (!program)
            return program.error();
        entry.program = *program;
        prepared.push_back(entry);
    }
    return prepared;
}

void ColumnDraw::upload(std::span<const Source> prepared, const GridTransform& transform) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mStride = (sizeof(shared::LaminaDrawConstants) + alignment - 1) / alignment * alignment;
    mBytes.assign(mStride * prepared.size(), std::byte{});

    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    shared::LaminaDrawConstants block{};
    block.depthRange = {near, 1.0 / (far - near), near * LAMINA_EYE_CUT, transform.size().z};
    block.passDepths = {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max(),
                        0.0, 0.0};
    block.size = {transform.size(), gridFlags(transform)};
    // Twice the rasterizer's snapping distance, and the rounding of normalized device coordinates.
    const auto columns = static_cast<float>(std::max(transform.size().x, transform.size().y));
    block.dilation.x = 2.0f * std::ldexp(1.0f, -static_cast<int>(mDevice->limits.subpixelBits)) +
                       columns * 0x1p-22f;
    std::size_t offset = 0;
    for (const Source& source : prepared) {
        const glm::dmat4 rows = glm::transpose(source.localToColumn);
        for (int row = 0; row < 3; ++row)
            block.localToColumn[row] = rows[row];
        block.pass = {0, source.materialId, 0, 0};
        std::memcpy(mBytes.data() + offset, &block, sizeof block);
        offset += mStride;
    }
    // New storage each time: draws of the last call may still read the old.
    mDevice->gl.NamedBufferData(mBlocks.id(), static_cast<GLsizeiptr>(mBytes.size()), mBytes.data(),
                                GL_STREAM_DRAW);
}

void ColumnDraw::draw(std::span<const GeometrySource> sources, std::span<const Source> prepared,
                      const DrawContext& context, gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        // Multi-bind leaves the host's generic uniform buffer binding alone.
        const GLuint buffer = mBlocks.id();
        const auto offset = static_cast<GLintptr>(i * mStride);
        constexpr GLsizeiptr kBlockBytes = sizeof(shared::LaminaDrawConstants);
        gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_DRAW_BLOCK_BINDING, 1, &buffer, &offset,
                            &kBlockBytes);
        gl.UseProgram(prepared[i].program);
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            guard.setHostPrimitiveRestart(false);
            gl.BindVertexArray(mVertexArray.id());
            drawMeshView(*mDevice, mVertexArray.id(), *view);
        } else {
            guard.setHostPrimitiveRestart(true);
            DrawContext hostContext = context;
            hostContext.program = prepared[i].program;
            std::get<DrawSource>(sources[i]).draw(hostContext);
        }
    }
}

} // namespace lamina
