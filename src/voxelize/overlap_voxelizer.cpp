#include "voxelize/overlap_voxelizer.hpp"

#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/overlap_passes.hpp"
#include "voxelize/solid_fill.hpp"

#include <vector>

namespace lamina {
namespace {

class OverlapVoxelizer final : public Voxelizer {
public:
    OverlapVoxelizer(std::shared_ptr<gl::DeviceState> device, Coverage coverage)
        : mDevice(std::move(device))
        , mCoverage(coverage)
        , mSources(mDevice, CaptureContent::Positions)
        , mSolid(mDevice)
        , mPasses(mDevice) {}

    /// Builds what every call needs.
    [[nodiscard]] Result<void> initialize();

    [[nodiscard]] Backend backend() const override { return Backend::Overlap; }
    [[nodiscard]] VoxelizerCapabilities capabilities() const override;
    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override;
    [[nodiscard]] Result<SolidReport> downloadSolidReport() const override {
        return isSolid() ? mSolid.download() : Voxelizer::downloadSolidReport();
    }

private:
    [[nodiscard]] bool isSolid() const { return mCoverage == Coverage::Solid; }
    [[nodiscard]] Result<GLuint> program(const char* thin, const char* parity) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    Coverage mCoverage;
    OverlapSources mSources;
    SolidFill mSolid;
    OverlapPasses mPasses;
    OverlapPrograms mPrograms;
};

Result<GLuint> OverlapVoxelizer::program(const char* thin, const char* parity) const {
    gl::ProgramDesc desc{"lamina overlap", {{GL_COMPUTE_SHADER, isSolid() ? parity : thin}}, {}};
    if (!isSolid())
        desc.defines = {{"LAMINA_COVERAGE", mCoverage == Coverage::Conservative
                                                ? "LAMINA_COVERAGE_CONSERVATIVE"
                                                : "LAMINA_COVERAGE_SEPARATING6"}};
    return gl::findOrBuildProgram(*mDevice, desc);
}

Result<void> OverlapVoxelizer::initialize() {
    auto small = program("voxelize/overlap.comp", "voxelize/parity.comp");
    if (!small)
        return small.error();
    auto large = program("voxelize/overlap_large.comp", "voxelize/parity_large.comp");
    if (!large)
        return large.error();
    mPrograms = {*small, *large};
    if (isSolid())
        if (auto ready = mSolid.initialize(); !ready)
            return ready;
    return mPasses.initialize();
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

Result<VoxelizeStats> OverlapVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform, VoxelGrid& out) {
    const gl::DebugGroup group(*mDevice, "lamina: voxelize (overlap)");
    auto parts = gridParts(*mDevice, transform);
    if (!parts)
        return parts.error();
    VoxelizeStats stats;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    auto prepared = mSources.prepare(sources, transform, stats);
    if (!prepared)
        return prepared.error();
    if (isSolid())
        if (auto reserved = mSolid.reserve(std::uint64_t{transform.size().x} * transform.size().y);
            !reserved)
            return reserved.error();
    if (auto resized = out.resize(transform, VoxelStore::Buffer); !resized)
        return resized.error();

    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_OVERLAP_BINDING_COUNT);
    const gl::PixelUnpackGuard unpackGuard(*mDevice); // clears of buffers depend on it
    mPasses.begin(*prepared, *parts, transform);
    // The host's shaders may have written the vertices, or read the grid's words.
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    const GLuint words = out.buffer();
    gl.ClearNamedBufferData(words, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    if (isSolid())
        mSolid.begin();
    for (std::size_t i = 0; i < parts->size(); ++i) {
        const GridPart& part = (*parts)[i];
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_WORDS_BINDING, 1, &words,
                            &part.offsetBytes, &part.sizeBytes);
        mPasses.run(mPrograms, i);
        if (isSolid() && mPasses.hasTriangles())
            mSolid.fill(part);
    }
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                     GL_SHADER_STORAGE_BARRIER_BIT);
    stats.passes = static_cast<std::uint32_t>(parts->size());
    stats.gridBytes = out.gpuBytes();
    return stats;
}

} // namespace

Result<std::unique_ptr<Voxelizer>> createOverlapVoxelizer(const Device& device,
                                                          const VoxelizerDesc& desc) {
    auto voxelizer = std::make_unique<OverlapVoxelizer>(device.state(), desc.coverage);
    if (auto ready = voxelizer->initialize(); !ready)
        return ready.error();
    return std::unique_ptr<Voxelizer>(std::move(voxelizer));
}

} // namespace lamina
