#include "voxelize/overlap_voxelizer.hpp"

#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/overlap_grid.hpp"
#include "voxelize/overlap_source.hpp"
#include "voxelize/solid_fill.hpp"

#include <array>
#include <cstring>
#include <vector>

namespace lamina {
namespace {

constexpr std::uint64_t kChunkTriangles = LAMINA_OVERLAP_CHUNK_TRIANGLES;

/// What one dispatch binds besides the grid.
struct Chunk {
    std::size_t source = 0;
    std::uint64_t firstTriangle = 0;
    std::uint64_t triangles = 0;
};

class OverlapVoxelizer final : public Voxelizer {
public:
    OverlapVoxelizer(std::shared_ptr<gl::DeviceState> device, Coverage coverage)
        : mDevice(std::move(device))
        , mCoverage(coverage)
        , mSources(mDevice)
        , mSolid(mDevice)
        , mConstants(gl::Buffer::create(mDevice, "lamina overlap constants")) {}

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
    [[nodiscard]] std::vector<Chunk> chunks(std::span<const OverlapSource> sources) const;
    void uploadConstants(std::span<const OverlapSource> sources, std::span<const Chunk> chunks,
                         std::span<const GridPart> parts, const GridTransform& transform);
    void resetQueue();
    void dispatch(const OverlapSource& source, const Chunk& chunk, std::size_t constantsIndex);

    std::shared_ptr<gl::DeviceState> mDevice;
    Coverage mCoverage;
    OverlapSources mSources;
    SolidFill mSolid;
    gl::Buffer mConstants;
    gl::Buffer mQueue;
    GLuint mProgram = 0;
    GLuint mLargeProgram = 0;
    std::vector<std::byte> mConstantBytes;
    std::size_t mConstantStride = 0;
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
    mProgram = *small;
    mLargeProgram = *large;
    if (isSolid())
        if (auto ready = mSolid.initialize(); !ready)
            return ready;
    constexpr std::uint64_t kQueueBytes =
        LAMINA_OVERLAP_CLASS_COUNT *
        (sizeof(shared::LaminaOverlapClass) + kChunkTriangles * sizeof(std::uint32_t));
    auto queue = gl::createBuffer(mDevice, kQueueBytes, nullptr, 0, "overlap voxelizer",
                                  "lamina overlap queue");
    if (!queue)
        return queue.error();
    mQueue = std::move(*queue);
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

std::vector<Chunk> OverlapVoxelizer::chunks(std::span<const OverlapSource> sources) const {
    std::vector<Chunk> chunks;
    for (std::size_t i = 0; i < sources.size(); ++i)
        for (std::uint64_t first = 0; first < sources[i].triangles; first += kChunkTriangles)
            chunks.push_back({i, first, std::min(kChunkTriangles, sources[i].triangles - first)});
    return chunks;
}

void OverlapVoxelizer::uploadConstants(std::span<const OverlapSource> sources,
                                       std::span<const Chunk> chunks,
                                       std::span<const GridPart> parts,
                                       const GridTransform& transform) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mConstantStride =
        (sizeof(shared::LaminaOverlapConstants) + alignment - 1) / alignment * alignment;
    mConstantBytes.assign(mConstantStride * chunks.size() * parts.size(), std::byte{});
    std::size_t offset = 0;
    for (const GridPart& part : parts)
        for (const Chunk& chunk : chunks) {
            shared::LaminaOverlapConstants block{};
            writeGridPart(part, transform, block);
            sources[chunk.source].write(chunk.firstTriangle, chunk.triangles,
                                        mDevice->limits.storageBufferOffsetAlignment, block);
            std::memcpy(mConstantBytes.data() + offset, &block, sizeof block);
            offset += mConstantStride;
        }
    // New storage each time: dispatches of the last call may still read the old.
    mDevice->gl.NamedBufferData(mConstants.id(), static_cast<GLsizeiptr>(mConstantBytes.size()),
                                mConstantBytes.data(), GL_STREAM_DRAW);
}

void OverlapVoxelizer::resetQueue() {
    GLuint groups = 1;
    for (GLintptr queue = 0; queue < LAMINA_OVERLAP_CLASS_COUNT; ++queue) {
        const std::array<GLuint, 4> head = {0, groups, 1, 0};
        constexpr GLintptr kBytes = sizeof head;
        mDevice->gl.ClearNamedBufferSubData(mQueue.id(), GL_RGBA32UI, queue * kBytes, kBytes,
                                            GL_RGBA_INTEGER, GL_UNSIGNED_INT, head.data());
        groups *= LAMINA_OVERLAP_CLASS_FACTOR;
    }
}

void OverlapVoxelizer::dispatch(const OverlapSource& source, const Chunk& chunk,
                                std::size_t constantsIndex) {
    const GladGLContext& gl = mDevice->gl;
    const GLuint constants = mConstants.id();
    const auto offset = static_cast<GLintptr>(constantsIndex * mConstantStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaOverlapConstants);
    gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_OVERLAP_BLOCK_BINDING, 1, &constants, &offset,
                        &kBytes);
    source.bind(*mDevice, chunk.firstTriangle, chunk.triangles);
    resetQueue();
    gl.UseProgram(mProgram);
    gl.DispatchCompute(static_cast<GLuint>((chunk.triangles + LAMINA_OVERLAP_GROUP_SIZE - 1) /
                                           LAMINA_OVERLAP_GROUP_SIZE),
                       1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    gl.UseProgram(mLargeProgram);
    for (GLint queue = 0; queue < LAMINA_OVERLAP_CLASS_COUNT; ++queue) {
        gl.ProgramUniform1i(mLargeProgram, 0, queue);
        gl.DispatchComputeIndirect(
            static_cast<GLintptr>(queue * sizeof(shared::LaminaOverlapClass)));
    }
    // The next chunk clears the queue and sets bits of the same words.
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
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

    const std::vector<Chunk> allChunks = chunks(*prepared);
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_OVERLAP_BINDING_COUNT);
    const gl::PixelUnpackGuard unpackGuard(*mDevice); // clears of buffers depend on it
    uploadConstants(*prepared, allChunks, *parts, transform);
    // The host's shaders may have written the vertices, or read the grid's words.
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    const GLuint words = out.buffer();
    gl.ClearNamedBufferData(words, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    const GLuint queue = mQueue.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_QUEUE_BINDING, 1, &queue);
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, queue);
    if (isSolid())
        mSolid.begin();
    std::size_t index = 0;
    for (const GridPart& part : *parts) {
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_WORDS_BINDING, 1, &words,
                            &part.offsetBytes, &part.sizeBytes);
        for (const Chunk& chunk : allChunks)
            dispatch((*prepared)[chunk.source], chunk, index++);
        if (isSolid() && !allChunks.empty())
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
