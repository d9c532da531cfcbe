#include "voxelize/overlap_voxelizer.hpp"

#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/flood_fill.hpp"
#include "voxelize/overlap_passes.hpp"
#include "voxelize/solid_fill.hpp"
#include "voxelize/solid_vote.hpp"

namespace lamina {
namespace {

class OverlapVoxelizer final : public Voxelizer {
public:
    OverlapVoxelizer(std::shared_ptr<gl::DeviceState> device, const VoxelizerDesc& desc)
        : mDevice(std::move(device))
        , mCoverage(desc.coverage)
        , mRule(desc.solidRule)
        , mSources(mDevice, CaptureContent::Positions)
        , mPasses(mDevice)
        , mFill(mDevice)
        , mVote(mDevice)
        , mFlood(mDevice) {}

    /// Builds what every call needs.
    [[nodiscard]] Result<void> initialize();

    [[nodiscard]] Backend backend() const override { return Backend::Overlap; }
    [[nodiscard]] VoxelizerCapabilities capabilities() const override;
    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override;
    [[nodiscard]] Result<SolidReport> downloadSolidReport() const override;
    [[nodiscard]] Result<BitGrid> downloadDoubtfulVoxels() const override;

private:
    [[nodiscard]] bool isSolid(SolidRule rule) const {
        return mCoverage == Coverage::Solid && mRule == rule;
    }
    [[nodiscard]] Result<void> buildPrograms();
    /// Makes room for what the solid rules need besides the grid.
    [[nodiscard]] Result<void> reserve(const GridTransform& transform,
                                       std::span<const GridPart> parts);
    /// Runs the triangles over the parts of the grid once.
    void visitParts(std::span<const OverlapSource> sources, std::span<const GridPart> parts,
                    const GridTransform& transform, GLuint words);

    std::shared_ptr<gl::DeviceState> mDevice;
    Coverage mCoverage;
    SolidRule mRule;
    OverlapSources mSources;
    OverlapPasses mPasses;
    SolidFill mFill;
    SolidVote mVote;
    FloodFill mFlood;
    OverlapPrograms mPrograms; ///< Unused by SolidRule::Voted.
};

Result<void> OverlapVoxelizer::buildPrograms() {
    const bool isParity = isSolid(SolidRule::Parity);
    const gl::ShaderDefine define =
        isParity ? gl::ShaderDefine{"LAMINA_CROSSINGS", "LAMINA_CROSSINGS_PARITY"}
                 : gl::ShaderDefine{"LAMINA_COVERAGE", mCoverage == Coverage::Separating6
                                                           ? "LAMINA_COVERAGE_SEPARATING6"
                                                           : "LAMINA_COVERAGE_CONSERVATIVE"};
    const auto build = [&](const char* shader) {
        return gl::findOrBuildProgram(*mDevice,
                                      {"lamina overlap", {{GL_COMPUTE_SHADER, shader}}, {define}});
    };
    auto small = build(isParity ? "voxelize/crossings.comp" : "voxelize/overlap.comp");
    if (!small)
        return small.error();
    auto large = build(isParity ? "voxelize/crossings_large.comp" : "voxelize/overlap_large.comp");
    if (!large)
        return large.error();
    mPrograms = {*small, *large};
    return {};
}

Result<void> OverlapVoxelizer::initialize() {
    if (auto ready = mPasses.initialize(); !ready)
        return ready;
    if (isSolid(SolidRule::Voted))
        return mVote.initialize();
    if (auto built = buildPrograms(); !built)
        return built;
    if (isSolid(SolidRule::Parity))
        return mFill.initialize();
    if (isSolid(SolidRule::FloodFill))
        return mFlood.initialize();
    return {};
}

VoxelizerCapabilities OverlapVoxelizer::capabilities() const {
    VoxelizerCapabilities capabilities;
    capabilities.maxColumns = maxOverlapColumns(*mDevice);
    capabilities.maxSlices = maxOverlapSlices(*mDevice);
    capabilities.slicesPerPass = kOverlapSlicesPerPart;
    capabilities.drawSources = true;
    capabilities.store = VoxelStore::Buffer;
    return capabilities;
}

Result<void> OverlapVoxelizer::reserve(const GridTransform& transform,
                                       std::span<const GridPart> parts) {
    if (isSolid(SolidRule::Parity))
        return mFill.reserve(std::uint64_t{transform.size().x} * transform.size().y);
    if (isSolid(SolidRule::Voted))
        return mVote.reserve(transform, parts);
    if (isSolid(SolidRule::FloodFill))
        return mFlood.reserve(transform, parts);
    return {};
}

void OverlapVoxelizer::visitParts(std::span<const OverlapSource> sources,
                                  std::span<const GridPart> parts, const GridTransform& transform,
                                  GLuint words) {
    mPasses.begin(sources, parts, transform);
    if (isSolid(SolidRule::Parity))
        mFill.begin();
    for (std::size_t part = 0; part < parts.size() && mPasses.hasTriangles(); ++part) {
        mDevice->gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_WORDS_BINDING, 1,
                                     &words, &parts[part].offsetBytes, &parts[part].sizeBytes);
        mPasses.run(mPrograms, part);
        if (isSolid(SolidRule::Parity))
            mFill.fill(parts[part]);
    }
}

Result<VoxelizeStats> OverlapVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform, VoxelGrid& out) {
    const gl::DebugGroup group(*mDevice, "lamina: voxelize (overlap)");
    if (auto own = gl::checkSameDevice(*mDevice, out.deviceState(), "voxelize", "a grid"); !own)
        return own.error();
    auto parts = gridParts(*mDevice, transform);
    if (!parts)
        return parts.error();
    VoxelizeStats stats;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    auto prepared = mSources.prepare(sources, transform, stats);
    if (!prepared)
        return prepared.error();
    if (auto reserved = reserve(transform, *parts); !reserved)
        return reserved.error();
    if (auto resized = out.resize(transform, VoxelStore::Buffer); !resized)
        return resized.error();

    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, LAMINA_SOLID_UNIFORM_COUNT,
                                      LAMINA_SOLID_BINDING_COUNT);
    const gl::PixelUnpackGuard unpackGuard(*mDevice); // clears of buffers depend on it
    // The host's shaders may have written the vertices, or read the grid's words.
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    const GLuint words = out.buffer();
    gl.ClearNamedBufferData(words, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    if (isSolid(SolidRule::Voted)) {
        stats.passes = mVote.run(mPasses, *prepared, *parts, transform, words);
    } else {
        visitParts(*prepared, *parts, transform, words);
        stats.passes = static_cast<std::uint32_t>(parts->size());
    }
    if (isSolid(SolidRule::FloodFill))
        mFlood.run(*parts, transform, words);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                     GL_SHADER_STORAGE_BARRIER_BIT);
    stats.gridBytes = out.gpuBytes();
    return stats;
}

Result<SolidReport> OverlapVoxelizer::downloadSolidReport() const {
    if (mCoverage != Coverage::Solid)
        return Voxelizer::downloadSolidReport();
    switch (mRule) {
    case SolidRule::Voted:
        return mVote.download();
    case SolidRule::FloodFill:
        return mFlood.download();
    case SolidRule::Parity:
        break;
    }
    return mFill.download();
}

Result<BitGrid> OverlapVoxelizer::downloadDoubtfulVoxels() const {
    return isSolid(SolidRule::Voted) ? mVote.downloadDoubtful()
                                     : Voxelizer::downloadDoubtfulVoxels();
}

} // namespace

Result<std::unique_ptr<Voxelizer>> createOverlapVoxelizer(const Device& device,
                                                          const VoxelizerDesc& desc) {
    auto voxelizer = std::make_unique<OverlapVoxelizer>(device.state(), desc);
    if (auto ready = voxelizer->initialize(); !ready)
        return ready.error();
    return std::unique_ptr<Voxelizer>(std::move(voxelizer));
}

} // namespace lamina
