#include "voxelize/slicemap_voxelizer.hpp"

#include "gl/binding_guards.hpp"
#include "gl/fragment_guards.hpp"
#include "grid/grid_constants.hpp"
#include "voxelize/column_parity.hpp"
#include "voxelize/slicemap_draw.hpp"
#include "voxelize/slicemap_groups.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

namespace lamina {
namespace {

constexpr std::uint32_t kMostTargets = 8;

/// All that one call needs, worked out before anything changes.
struct Plan {
    GridTransform transform;
    Split split = Split::None;
    std::uint32_t gridCount = 1;
    bool hasBounds = false;
    SlicemapSources sources;
    SlicemapSources bounds; ///< What the range pass draws: the bounds or the sources.
    std::vector<SlicemapGroups> groups;
    std::vector<SlicemapPass> passes; ///< The range pass, if any, and one for each of `groups`.
};

class SlicemapVoxelizer final : public Voxelizer {
public:
    SlicemapVoxelizer(std::shared_ptr<gl::DeviceState> device, const VoxelizerDesc& desc)
        : mDevice(std::move(device))
        , mBackend(desc.backend)
        , mCoverage(desc.coverage)
        , mIsLocal(desc.localRanges || desc.backend == Backend::LocalSlicemap)
        , mStore(desc.store.value_or(VoxelStore::Texture))
        , mColumnParity(mDevice)
        , mDraw(mDevice)
        , mFramebuffer(gl::Framebuffer::create(mDevice, "lamina slicemap"))
        , mClasses(gl::Buffer::create(mDevice, "lamina colour classes")) {}

    [[nodiscard]] Backend backend() const override { return mBackend; }
    [[nodiscard]] VoxelizerCapabilities capabilities() const override;

    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override {
        return voxelizeWith(sources, transform, {}, {&out, 1});
    }
    [[nodiscard]] Result<VoxelizeStats> voxelizeWith(std::span<const GeometrySource> sources,
                                                     const GridTransform& transform,
                                                     const VoxelizeOptions& options,
                                                     std::span<VoxelGrid> grids) override;

    [[nodiscard]] Result<SolidReport> downloadSolidReport() const override {
        return isSolid() ? mColumnParity.download() : Voxelizer::downloadSolidReport();
    }

    /// Builds the programs of MeshView sources for grids of up to 128 slices.
    [[nodiscard]] Result<void> buildPrograms() const;

private:
    [[nodiscard]] bool isSolid() const { return mCoverage == Coverage::Solid; }
    /// Render targets of a pass at most.
    [[nodiscard]] std::uint32_t maxTargets() const {
        return mBackend == Backend::MrtSlicemap
                   ? std::min(kMostTargets, mDevice->limits.maxDrawBuffers)
                   : 1;
    }
    [[nodiscard]] SlicemapStage bitStage(VoxelStore store, bool isSplit,
                                         std::uint32_t targets) const;
    [[nodiscard]] Result<void> checkOptions(const VoxelizeOptions& options,
                                            std::size_t gridCount) const;
    [[nodiscard]] Result<std::vector<SlicemapGroups>>
    groupRanges(const GridTransform& transform, VoxelStore store, std::uint32_t gridCount) const;
    [[nodiscard]] Result<Plan> plan(std::span<const GeometrySource> sources,
                                    const GridTransform& transform, const VoxelizeOptions& options,
                                    std::uint32_t gridCount, VoxelStore store) const;

    void uploadClasses(std::span<const Material> materials);
    void drawRanges(const Plan& plan, GLuint rangeTexture, gl::RasterStateGuard& guard);
    void drawToTargets(const Plan& plan, std::uint32_t pass, std::span<const VoxelGrid> grids,
                       gl::RasterStateGuard& guard);
    void drawToBuffer(const Plan& plan, std::uint32_t pass, const VoxelGrid& grid,
                      gl::RasterStateGuard& guard);
    void bindInputs(const VoxelGrid& grid) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    Backend mBackend;
    Coverage mCoverage;
    bool mIsLocal;
    VoxelStore mStore;
    ColumnParity mColumnParity;
    SlicemapDraw mDraw;
    gl::Framebuffer mFramebuffer;
    gl::Buffer mClasses;
};

VoxelizerCapabilities SlicemapVoxelizer::capabilities() const {
    const DeviceLimits& limits = mDevice->limits;
    VoxelizerCapabilities capabilities;
    capabilities.maxColumns =
        std::min({limits.maxTextureSize, limits.maxViewportWidth, limits.maxViewportHeight});
    capabilities.maxSlices = limits.maxArrayTextureLayers * BitGrid::kSlicesPerGroup;
    capabilities.slicesPerPass = maxTargets() * BitGrid::kSlicesPerGroup;
    capabilities.perspective = true;
    capabilities.anyDistribution = true;
    capabilities.drawSources = true;
    capabilities.store = mStore;
    capabilities.localRanges = mIsLocal;
    capabilities.splits = !isSolid();
    return capabilities;
}

SlicemapStage SlicemapVoxelizer::bitStage(VoxelStore store, bool isSplit,
                                          std::uint32_t targets) const {
    // Targets that a program writes and a pass lacks cost nothing: few programs serve all counts.
    const std::uint32_t written = store == VoxelStore::Buffer ? 0 : std::bit_ceil(targets);
    return {"voxelize/slicemap.frag",
            {{"LAMINA_COVERAGE", slicemapCoverage(mCoverage)},
             {"LAMINA_LOCAL", mIsLocal ? "1" : "0"},
             {"LAMINA_SPLIT", isSplit ? "1" : "0"},
             {"LAMINA_TARGETS", std::to_string(written)}}};
}

Result<void> SlicemapVoxelizer::buildPrograms() const {
    if (mIsLocal)
        if (auto built = mDraw.meshProgram(slicemapRangeStage(mCoverage)); !built)
            return built.error();
    if (auto built = mDraw.meshProgram(bitStage(mStore, false, 1)); !built)
        return built.error();
    return {};
}

Result<void> SlicemapVoxelizer::checkOptions(const VoxelizeOptions& options,
                                             std::size_t gridCount) const {
    const auto invalid = [](std::string text) {
        return Error{ErrorCode::InvalidArgument, "voxelize: " + std::move(text)};
    };
    if (options.split != Split::None && isSolid())
        return Error{
            ErrorCode::Unsupported,
            "voxelize: expected a coverage of surfaces to split, found solid; use coverage "
            "conservative or filled, or a voxelize() call for each closed mesh"};
    if (options.split > Split::ColorClass)
        return invalid("expected a value of Split, found " +
                       std::to_string(static_cast<int>(options.split)));
    const std::size_t least = options.split == Split::Facing ? 2 : 1;
    const std::size_t most = options.split == Split::ColorClass ? kMostTargets : least;
    if (gridCount < least || gridCount > most)
        return invalid("expected " +
                       (least == most ? std::to_string(least)
                                      : std::to_string(least) + " to " + std::to_string(most)) +
                       (most == 1 ? " grid" : " grids") + " for this split, found " +
                       std::to_string(gridCount));
    if (!options.bounds.empty() && !mIsLocal)
        return invalid("expected bounding geometry for local ranges alone, found uniform ones; "
                       "create the voxelizer with localRanges");
    if (options.split != Split::ColorClass)
        return {};
    if (options.materials.empty() || options.materials.size() > LAMINA_MAX_CLASS_MATERIALS)
        return invalid("expected 1 to " + std::to_string(LAMINA_MAX_CLASS_MATERIALS) +
                       " materials to split by colour class, found " +
                       std::to_string(options.materials.size()));
    for (std::size_t i = 0; i < options.materials.size(); ++i)
        if (options.materials[i].colorClass >= gridCount)
            return invalid("expected colour classes below the number of grids, " +
                           std::to_string(gridCount) + ", found " +
                           std::to_string(options.materials[i].colorClass) + " in material " +
                           std::to_string(i));
    return {};
}

Result<Plan> SlicemapVoxelizer::plan(std::span<const GeometrySource> sources,
                                     const GridTransform& transform, const VoxelizeOptions& options,
                                     std::uint32_t gridCount, VoxelStore store) const {
    Plan plan{transform, options.split, gridCount, !options.bounds.empty(), {}, {}, {}, {}};
    auto groups =
        slicemapGroups(*mDevice, transform, store, std::max(maxTargets() / gridCount, 1u));
    if (!groups)
        return groups.error();
    plan.groups = std::move(*groups);
    const std::uint32_t targets = plan.groups.front().count * gridCount;
    auto prepared =
        mDraw.prepare(sources, transform, bitStage(store, options.split != Split::None, targets));
    if (!prepared)
        return prepared.error();
    plan.sources = std::move(*prepared);
    if (mIsLocal) {
        auto bounds = mDraw.prepare(plan.hasBounds ? options.bounds : sources, transform,
                                    slicemapRangeStage(mCoverage));
        if (!bounds)
            return bounds.error();
        plan.bounds = std::move(*bounds);
    }
    return plan;
}

/// The passes of a plan, which must stay where it is.
void addPasses(Plan& plan, bool isLocal, Coverage coverage) {
    SlicemapPass pass;
    pass.nearDepth = plan.transform.nearDepth();
    pass.farDepth = plan.transform.farDepth();
    if (isLocal) {
        pass.sources = &plan.bounds;
        plan.passes.push_back(pass);
    }
    pass.sources = &plan.sources;
    pass.gridCount = plan.gridCount;
    pass.split = plan.split == Split::ColorClass ? LAMINA_SPLIT_CLASS : LAMINA_SPLIT_FACING;
    for (const SlicemapGroups& groups : plan.groups) {
        pass.firstSlice = groups.first * BitGrid::kSlicesPerGroup;
        pass.sliceCount = std::min(groups.count * BitGrid::kSlicesPerGroup,
                                   plan.transform.size().z - pass.firstSlice);
        pass.skippedWords = groups.skippedWords;
        if (!isLocal)
            limitDepths(pass, plan.transform, coverage);
        plan.passes.push_back(pass);
    }
}

void SlicemapVoxelizer::uploadClasses(std::span<const Material> materials) {
    std::array<std::uint32_t, LAMINA_MAX_CLASS_MATERIALS> entries{};
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Material& material = materials[std::min(i, materials.size() - 1)];
        entries[i] = material.colorClass;
        if (material.orientation != OrientationRule::BackFaces)
            entries[i] |= LAMINA_CLASS_FRONT;
        if (material.orientation != OrientationRule::FrontFaces)
            entries[i] |= LAMINA_CLASS_BACK;
    }
    mDevice->gl.NamedBufferData(mClasses.id(), sizeof entries, entries.data(), GL_STREAM_DRAW);
}

void SlicemapVoxelizer::bindInputs(const VoxelGrid& grid) const {
    const GladGLContext& gl = mDevice->gl;
    // Multi-bind leaves the host's generic bindings alone.
    const std::array<GLuint, 2> blocks{grid.uniformBuffer(), mClasses.id()};
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_PASS_GRID_BLOCK_BINDING, 2, blocks.data());
    if (mIsLocal)
        gl.BindImageTexture(LAMINA_RANGE_IMAGE_UNIT, grid.rangeTexture(), 0, GL_FALSE, 0,
                            GL_READ_ONLY, GL_RG32F);
}

void SlicemapVoxelizer::drawRanges(const Plan& plan, GLuint rangeTexture,
                                   gl::RasterStateGuard& guard) {
    const gl::DebugGroup group(*mDevice, "lamina: column ranges");
    const GladGLContext& gl = mDevice->gl;
    const gl::BlendStateGuard blend(*mDevice, 1, gl::Blending::Minimum);
    const GLuint framebuffer = mFramebuffer.id();
    constexpr GLenum kTarget = GL_COLOR_ATTACHMENT0;
    gl.NamedFramebufferTexture(framebuffer, kTarget, rangeTexture, 0);
    gl.NamedFramebufferDrawBuffers(framebuffer, 1, &kTarget);
    constexpr std::array<GLfloat, 4> kEmpty{static_cast<GLfloat>(LAMINA_EMPTY_COLUMN),
                                            static_cast<GLfloat>(LAMINA_EMPTY_COLUMN)};
    gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, kEmpty.data());
    mDraw.draw(plan.passes, 0, guard, [] {});
    gl.NamedFramebufferTexture(framebuffer, kTarget, 0, 0);
}

void SlicemapVoxelizer::drawToTargets(const Plan& plan, std::uint32_t pass,
                                      std::span<const VoxelGrid> grids,
                                      gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    const SlicemapGroups& range = plan.groups[pass - (mIsLocal ? 1 : 0)];
    const GLuint framebuffer = mFramebuffer.id();
    std::array<GLenum, kMostTargets> targets{};
    GLsizei count = 0;
    for (std::uint32_t group = 0; group < range.count; ++group)
        for (const VoxelGrid& grid : grids) {
            targets[count] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(count);
            gl.NamedFramebufferTextureLayer(framebuffer, targets[count], grid.texture(), 0,
                                            static_cast<GLint>(range.first + group));
            ++count;
        }
    gl.NamedFramebufferDrawBuffers(framebuffer, count, targets.data());
    gl.Disable(GL_COLOR_LOGIC_OP);
    constexpr std::array<GLuint, 4> kClear{};
    for (GLint i = 0; i < count; ++i)
        gl.ClearNamedFramebufferuiv(framebuffer, GL_COLOR, i, kClear.data());
    gl.Enable(GL_COLOR_LOGIC_OP);
    gl.LogicOp(isSolid() ? GL_XOR : GL_OR);
    mDraw.draw(plan.passes, pass, guard, [&] { bindInputs(grids.front()); });
    for (GLsizei i = 0; i < count; ++i)
        gl.NamedFramebufferTexture(framebuffer, targets[i], 0, 0);
}

void SlicemapVoxelizer::drawToBuffer(const Plan& plan, std::uint32_t pass, const VoxelGrid& grid,
                                     gl::RasterStateGuard& guard) {
    const GladGLContext& gl = mDevice->gl;
    const SlicemapGroups& range = plan.groups[pass - (mIsLocal ? 1 : 0)];
    const GLuint buffer = grid.buffer();
    mDraw.draw(plan.passes, pass, guard, [&] {
        bindInputs(grid);
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_WORDS_BINDING, 1, &buffer,
                            &range.offsetBytes, &range.sizeBytes);
    });
}

Result<VoxelizeStats> SlicemapVoxelizer::voxelizeWith(std::span<const GeometrySource> sources,
                                                      const GridTransform& transform,
                                                      const VoxelizeOptions& options,
                                                      std::span<VoxelGrid> grids) {
    const glm::uvec3 size = transform.size();
    if (const VoxelizerCapabilities able = capabilities();
        size.x > able.maxColumns || size.y > able.maxColumns || size.z > able.maxSlices)
        return Error{ErrorCode::DeviceLimit,
                     "voxelize: grid " + transform.describe() + ", the device's limit is " +
                         std::to_string(able.maxColumns) + " x " + std::to_string(able.maxColumns) +
                         " x " + std::to_string(able.maxSlices) + "; use a smaller grid"};
    if (auto valid = checkOptions(options, grids.size()); !valid)
        return valid.error();
    for (const VoxelGrid& grid : grids)
        if (auto own = gl::checkSameDevice(*mDevice, grid.deviceState(), "voxelize", "a grid");
            !own)
            return own.error();
    const gl::DebugGroup group(*mDevice, "lamina: voxelize (" + std::string(name(mBackend)) + ")");
    const VoxelStore store = options.split == Split::None ? mStore : VoxelStore::Texture;
    auto planned =
        plan(sources, transform, options, static_cast<std::uint32_t>(grids.size()), store);
    if (!planned)
        return planned.error();
    addPasses(*planned, mIsLocal, mCoverage);
    if (isSolid())
        if (auto reserved = mColumnParity.reserve(size); !reserved)
            return reserved.error();
    if (auto resized = VoxelGrid::resizeAll(grids, transform, store,
                                            mIsLocal ? SliceRanges::Local : SliceRanges::Uniform);
        !resized)
        return resized.error();

    const GladGLContext& gl = mDevice->gl;
    gl::RasterStateGuard guard(*mDevice, 3);
    const gl::ImageUnitGuard images(*mDevice, mIsLocal    ? LAMINA_RANGE_IMAGE_UNIT + 1
                                              : isSolid() ? LAMINA_COLUMN_PARITY_IMAGE + 1
                                                          : 0);
    const gl::IndexedBufferBindings storage(
        gl, GL_SHADER_STORAGE_BUFFER, store == VoxelStore::Buffer ? LAMINA_WORDS_BINDING + 1 : 0);
    if (isSolid())
        mColumnParity.begin();
    mDraw.upload(planned->passes, transform);
    if (options.split == Split::ColorClass)
        uploadClasses(options.materials);
    const VoxelGrid& first = grids.front();
    if (store == VoxelStore::Buffer) {
        gl.ClearNamedBufferData(first.buffer(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
        gl.NamedFramebufferParameteri(mFramebuffer.id(), GL_FRAMEBUFFER_DEFAULT_WIDTH,
                                      static_cast<GLint>(size.x));
        gl.NamedFramebufferParameteri(mFramebuffer.id(), GL_FRAMEBUFFER_DEFAULT_HEIGHT,
                                      static_cast<GLint>(size.y));
    }
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer.id());
    gl.ViewportIndexedf(0, 0.0f, 0.0f, static_cast<float>(size.x), static_cast<float>(size.y));
    for (std::uint32_t pass = 0; pass < planned->passes.size(); ++pass) {
        if (mIsLocal && pass == 0)
            drawRanges(*planned, first.rangeTexture(), guard);
        else if (store == VoxelStore::Buffer)
            drawToBuffer(*planned, pass, first, guard);
        else
            drawToTargets(*planned, pass, grids, guard);
    }
    if (store == VoxelStore::Buffer) {
        gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                         GL_SHADER_STORAGE_BARRIER_BIT);
        storage.restore(gl);
    }

    if (isSolid())
        mColumnParity.end();

    VoxelizeStats stats;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    stats.passes = static_cast<std::uint32_t>(planned->passes.size());
    stats.meshTriangles = planned->sources.meshTriangles;
    for (const VoxelGrid& grid : grids)
        stats.gridBytes += grid.gpuBytes();
    return stats;
}

} // namespace

Result<std::unique_ptr<Voxelizer>> createSlicemapVoxelizer(const Device& device,
                                                           const VoxelizerDesc& desc) {
    auto voxelizer = std::make_unique<SlicemapVoxelizer>(device.state(), desc);
    if (auto built = voxelizer->buildPrograms(); !built)
        return built.error();
    return std::unique_ptr<Voxelizer>(std::move(voxelizer));
}

} // namespace lamina
