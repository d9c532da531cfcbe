#include "voxelize/slicemap_voxelizer.hpp"

#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"
#include "voxelize/column_parity.hpp"
#include "voxelize/mesh_view.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace lamina {
namespace {

/// The program of one source and the place of its draw constants.
struct PreparedSource {
    GLuint program = 0;
    glm::dmat4 localToColumn{1.0};
    std::uint32_t materialId = 0;
};

std::string coverageDefine(Coverage coverage) {
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

/// The depths of the triangles that matter to the pass of slices [first, end).
glm::dvec4 passDepths(const GridTransform& transform, std::uint32_t first, std::uint32_t end,
                      Coverage coverage) {
    constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    const double allowance = (transform.farDepth() - transform.nearDepth()) * 0x1p-20;
    double low = transform.depthAtSlice(first) - allowance;
    double high = transform.depthAtSlice(end) + allowance;
    if (coverage == Coverage::Solid) {
        // A crossing toggles all slices before it. The first pass counts those before the grid too.
        low = first == 0 ? -kUnbounded : low;
        high = kUnbounded;
    }
    return {low, high, 0.0, 0.0};
}

class SlicemapVoxelizer final : public Voxelizer {
public:
    SlicemapVoxelizer(std::shared_ptr<gl::DeviceState> device, Coverage coverage)
        : mDevice(std::move(device))
        , mCoverage(coverage)
        , mColumnParity(mDevice)
        , mFramebuffer(gl::Framebuffer::create(mDevice, "lamina slicemap"))
        , mVertexArray(gl::VertexArray::create(mDevice, "lamina mesh view"))
        , mDrawBlocks(gl::Buffer::create(mDevice, "lamina draw constants")) {
        const GladGLContext& gl = mDevice->gl;
        gl.EnableVertexArrayAttrib(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION);
        gl.VertexArrayAttribFormat(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 3, GL_FLOAT,
                                   GL_FALSE, 0);
        gl.VertexArrayAttribBinding(mVertexArray.id(), LAMINA_ATTRIBUTE_POSITION, 0);
    }

    [[nodiscard]] Backend backend() const override { return Backend::Slicemap; }

    [[nodiscard]] VoxelizerCapabilities capabilities() const override {
        const DeviceLimits& limits = mDevice->limits;
        VoxelizerCapabilities capabilities;
        capabilities.maxColumns =
            std::min({limits.maxTextureSize, limits.maxViewportWidth, limits.maxViewportHeight});
        capabilities.maxSlices = limits.maxArrayTextureLayers * BitGrid::kSlicesPerGroup;
        capabilities.slicesPerPass = BitGrid::kSlicesPerGroup;
        capabilities.perspective = true;
        capabilities.anyDistribution = true;
        capabilities.drawSources = true;
        return capabilities;
    }

    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override;

    /// Builds the program of MeshView sources.
    [[nodiscard]] Result<GLuint> meshProgram() const {
        return program({GL_VERTEX_SHADER, "voxelize/mesh.vert"});
    }

    [[nodiscard]] Result<SolidReport> downloadSolidReport() const override {
        return isSolid() ? mColumnParity.download() : Voxelizer::downloadSolidReport();
    }

private:
    [[nodiscard]] bool isSolid() const { return mCoverage == Coverage::Solid; }
    [[nodiscard]] Result<GLuint> program(gl::ProgramStage vertexStage) const {
        return gl::findOrBuildProgram(*mDevice, {"lamina slicemap",
                                                 {std::move(vertexStage),
                                                  {GL_GEOMETRY_SHADER, "voxelize/slicemap.geom"},
                                                  {GL_FRAGMENT_SHADER, "voxelize/slicemap.frag"}},
                                                 {{"LAMINA_COVERAGE", coverageDefine(mCoverage)}}});
    }

    [[nodiscard]] Result<std::vector<PreparedSource>>
    prepare(std::span<const GeometrySource> sources, const GridTransform& transform,
            VoxelizeStats& stats) const;
    void uploadDrawBlocks(std::span<const PreparedSource> sources, const GridTransform& transform,
                          std::uint32_t passCount);
    void drawPass(std::span<const GeometrySource> sources, std::span<const PreparedSource> prepared,
                  const DrawContext& context, gl::RasterStateGuard& guard);

    std::shared_ptr<gl::DeviceState> mDevice;
    Coverage mCoverage;
    ColumnParity mColumnParity;
    gl::Framebuffer mFramebuffer;
    gl::VertexArray mVertexArray;
    gl::Buffer mDrawBlocks;
    std::vector<std::byte> mDrawBlockBytes;
    std::size_t mDrawBlockStride = 0;
};

Result<std::vector<PreparedSource>>
SlicemapVoxelizer::prepare(std::span<const GeometrySource> sources, const GridTransform& transform,
                           VoxelizeStats& stats) const {
    std::vector<PreparedSource> prepared;
    prepared.reserve(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
        PreparedSource entry;
        entry.localToColumn = transform.worldToColumn();
        Result<GLuint> built = Error{};
        if (const auto* view = std::get_if<MeshView>(&sources[i])) {
            if (auto valid = checkMeshView(*mDevice, *view, i); !valid)
                return valid.error();
            entry.localToColumn = transform.worldToColumn() * glm::dmat4(view->model);
            entry.materialId = view->materialId;
            stats.meshTriangles += triangleCount(*view);
            built = meshProgram();
        } else {
            const auto& source = std::get<DrawSource>(sources[i]);
            if (auto valid = checkDrawSource(source, i); !valid)
                return valid.error();
            built = program({GL_VERTEX_SHADER, "voxelize/vertex_main.glsl", source.vertexShader});
        }
        if (!built)
            return built.error();
        entry.program = *built;
        prepared.push_back(entry);
    }
    return prepared;
}

void SlicemapVoxelizer::uploadDrawBlocks(std::span<const PreparedSource> sources,
                                         const GridTransform& transform, std::uint32_t passCount) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mDrawBlockStride =
        (sizeof(shared::LaminaDrawConstants) + alignment - 1) / alignment * alignment;
    mDrawBlockBytes.assign(mDrawBlockStride * sources.size() * passCount, std::byte{});

    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    shared::LaminaDrawConstants block{};
    block.depthRange = {near, 1.0 / (far - near), near * LAMINA_EYE_CUT, transform.size().z};
    block.size = {transform.size(), gridFlags(transform)};
    // Twice the rasterizer's snapping distance, and the rounding of normalized device coordinates.
    const auto columns = static_cast<float>(std::max(transform.size().x, transform.size().y));
    block.dilation.x = 2.0f * std::ldexp(1.0f, -static_cast<int>(mDevice->limits.subpixelBits)) +
                       columns * 0x1p-22f;

    std::size_t offset = 0;
    for (std::uint32_t pass = 0; pass < passCount; ++pass) {
        const std::uint32_t firstSlice = pass * BitGrid::kSlicesPerGroup;
        const std::uint32_t endSlice =
            std::min(firstSlice + BitGrid::kSlicesPerGroup, transform.size().z);
        block.passDepths = passDepths(transform, firstSlice, endSlice, mCoverage);
        for (const PreparedSource& source : sources) {
            const glm::dmat4 rows = glm::transpose(source.localToColumn);
            for (int row = 0; row < 3; ++row)
                block.localToColumn[row] = rows[row];
            block.pass = {firstSlice, source.materialId, 0, 0};
            std::memcpy(mDrawBlockBytes.data() + offset, &block, sizeof block);
            offset += mDrawBlockStride;
        }
    }
    // New storage each time: draws of the last call may still read the old.
    mDevice->gl.NamedBufferData(mDrawBlocks.id(), static_cast<GLsizeiptr>(mDrawBlockBytes.size()),
                                mDrawBlockBytes.data(), GL_STREAM_DRAW);
}

void SlicemapVoxelizer::drawPass(std::span<const GeometrySource> sources,
                                 std::span<const PreparedSource> prepared,
                                 const DrawContext& context, gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        // Multi-bind leaves the host's generic uniform buffer binding alone.
        const GLuint buffer = mDrawBlocks.id();
        const auto offset =
            static_cast<GLintptr>((context.pass * sources.size() + i) * mDrawBlockStride);
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

Result<VoxelizeStats> SlicemapVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                  const GridTransform& transform, VoxelGrid& out) {
    const glm::uvec3 size = transform.size();
    if (const VoxelizerCapabilities able = capabilities();
        size.x > able.maxColumns || size.y > able.maxColumns || size.z > able.maxSlices)
        return Error{ErrorCode::DeviceLimit,
                     "voxelize: grid " + transform.describe() + ", the device's limit is " +
                         std::to_string(able.maxColumns) + " x " + std::to_string(able.maxColumns) +
                         " x " + std::to_string(able.maxSlices) + "; use a smaller grid"};
    const gl::DebugGroup group(*mDevice, "lamina: voxelize (slicemap)");
    VoxelizeStats stats;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    auto prepared = prepare(sources, transform, stats);
    if (!prepared)
        return prepared.error();
    if (isSolid())
        if (auto reserved = mColumnParity.reserve(size); !reserved)
            return reserved.error();
    if (auto resized = out.resize(transform, VoxelStore::Texture); !resized)
        return resized.error();

    const std::uint32_t passCount =
        (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
    const GladGLContext& gl = mDevice->gl;
    gl::RasterStateGuard guard(*mDevice, 2);
    const gl::ImageUnitGuard imageGuard(*mDevice, isSolid() ? 1 : 0);
    if (isSolid())
        mColumnParity.begin();
    uploadDrawBlocks(*prepared, transform, passCount);
    const GLuint gridBlock = out.uniformBuffer();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_PASS_GRID_BLOCK_BINDING, 1, &gridBlock);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(size.x), static_cast<float>(size.y));
    gl.LogicOp(isSolid() ? GL_XOR : GL_OR);
    for (std::uint32_t pass = 0; pass < passCount; ++pass) {
        gl.NamedFramebufferTextureLayer(mFramebuffer.id(), GL_COLOR_ATTACHMENT0, out.texture(), 0,
                                        static_cast<GLint>(pass));
        gl.Disable(GL_COLOR_LOGIC_OP);
        constexpr std::array<GLuint, 4> kClear{};
        gl.ClearNamedFramebufferuiv(mFramebuffer.id(), GL_COLOR, 0, kClear.data());
        gl.Enable(GL_COLOR_LOGIC_OP);
        DrawContext context;
        context.pass = pass;
        context.passCount = passCount;
        drawPass(sources, *prepared, context, guard);
    }
    gl.NamedFramebufferTexture(mFramebuffer.id(), GL_COLOR_ATTACHMENT0, 0, 0);
    if (isSolid())
        mColumnParity.end();
    stats.passes = passCount;
    stats.gridBytes = out.gpuBytes();
    return stats;
}

} // namespace

Result<std::unique_ptr<Voxelizer>> createSlicemapVoxelizer(const Device& device,
                                                           const VoxelizerDesc& desc) {
    auto voxelizer = std::make_unique<SlicemapVoxelizer>(device.state(), desc.coverage);
    if (auto built = voxelizer->meshProgram(); !built)
        return built.error();
    return std::unique_ptr<Voxelizer>(std::move(voxelizer));
}

} // namespace lamina
