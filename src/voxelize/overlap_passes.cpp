#include "voxelize/overlap_passes.hpp"

#include <algorithm>
#include <cstring>

namespace lamina {
namespace {

constexpr std::uint64_t kChunkTriangles = LAMINA_OVERLAP_CHUNK_TRIANGLES;

} // namespace

Result<void> OverlapPasses::initialize() {
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

void OverlapPasses::begin(std::span<const OverlapSource> sources, std::span<const GridPart> parts,
                          const GridTransform& transform) {
    mSources = sources;
    mChunks.clear();
    for (std::size_t i = 0; i < sources.size(); ++i)
        for (std::uint64_t first = 0; first < sources[i].triangles; first += kChunkTriangles)
            mChunks.push_back({i, first, std::min(kChunkTriangles, sources[i].triangles - first)});
    uploadConstants(parts, transform);
}

void OverlapPasses::uploadConstants(std::span<const GridPart> parts,
                                    const GridTransform& transform) {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mConstantStride =
        (sizeof(shared::LaminaOverlapConstants) + alignment - 1) / alignment * alignment;
    mConstantBytes.assign(mConstantStride * mChunks.size() * parts.size(), std::byte{});
    std::size_t offset = 0;
    for (const GridPart& part : parts)
        for (const Chunk& chunk : mChunks) {
            shared::LaminaOverlapConstants block{};
            writeGridPart(part, transform, block);
            mSources[chunk.source].write(chunk.firstTriangle, chunk.triangles,
                                         mDevice->limits.storageBufferOffsetAlignment, block);
            std::memcpy(mConstantBytes.data() + offset, &block, sizeof block);
            offset += mConstantStride;
        }
    // New storage each time: dispatches of the last call may still read the old.
    mDevice->gl.NamedBufferData(mConstants.id(), static_cast<GLsizeiptr>(mConstantBytes.size()),
                                mConstantBytes.data(), GL_STREAM_DRAW);
}

void OverlapPasses::resetQueue() {
    GLuint groups = 1;
    for (GLintptr queue = 0; queue < LAMINA_OVERLAP_CLASS_COUNT; ++queue) {
        const std::array<GLuint, 4> head = {0, groups, 1, 0};
        constexpr GLintptr kBytes = sizeof head;
        mDevice->gl.ClearNamedBufferSubData(mQueue.id(), GL_RGBA32UI, queue * kBytes, kBytes,
                                            GL_RGBA_INTEGER, GL_UNSIGNED_INT, head.data());
        groups *= LAMINA_OVERLAP_CLASS_FACTOR;
    }
}

std::vector<GLuint> OverlapPasses::smallGroups() const {
    std::vector<GLuint> groups;
    for (const Chunk& chunk : mChunks)
        groups.push_back(static_cast<GLuint>((chunk.triangles + LAMINA_OVERLAP_GROUP_SIZE - 1) /
                                             LAMINA_OVERLAP_GROUP_SIZE));
    return groups;
}

void OverlapPasses::run(const OverlapPrograms& programs, std::size_t part,
                        const DispatchGate& gate) {
    const GladGLContext& gl = mDevice->gl;
    const GLuint queue = mQueue.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_QUEUE_BINDING, 1, &queue);
    const std::vector<GLuint> groups = smallGroups();
    for (std::size_t i = 0; i < mChunks.size(); ++i) {
        bind(mChunks[i], part * mChunks.size() + i);
        resetQueue();
        gl.UseProgram(programs.smallTriangles);
        if (gate.buffer == 0) {
            gl.DispatchCompute(groups[i], 1, 1);
        } else {
            gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, gate.buffer);
            gl.DispatchComputeIndirect(gate.offset + static_cast<GLintptr>(i) * gate.stride);
        }
        gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
        dispatchLarge(programs);
    }
}

void OverlapPasses::bind(const Chunk& chunk, std::size_t constantsIndex) {
    const GLuint constants = mConstants.id();
    const auto offset = static_cast<GLintptr>(constantsIndex * mConstantStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaOverlapConstants);
    mDevice->gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_OVERLAP_BLOCK_BINDING, 1, &constants,
                                 &offset, &kBytes);
    mSources[chunk.source].bind(*mDevice, chunk.firstTriangle, chunk.triangles);
}

void OverlapPasses::dispatchLarge(const OverlapPrograms& programs) {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(programs.largeTriangles);
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, mQueue.id());
    for (GLint queue = 0; queue < LAMINA_OVERLAP_CLASS_COUNT; ++queue) {
        gl.ProgramUniform1i(programs.largeTriangles, 0, queue);
        gl.DispatchComputeIndirect(
            static_cast<GLintptr>(queue * sizeof(shared::LaminaOverlapClass)));
    }
    // The next chunk clears the queue and writes where this one wrote.
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

} // namespace lamina
