#pragma once

#include "voxelize/overlap_grid.hpp"
#include "voxelize/overlap_source.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lamina {

/// A program that takes small triangles and enqueues the others (overlap_queue.glsl), and the one
/// that takes those.
struct OverlapPrograms {
    GLuint smallTriangles = 0;
    GLuint largeTriangles = 0;
};

/// Indirect dispatches that something on the device may have emptied.
struct DispatchGate {
    GLuint buffer = 0; ///< 0: not gated.
    GLintptr offset = 0;
    GLintptr stride = 0;
};

/// Runs such programs over every triangle of the sources and every part of a grid.
class OverlapPasses {
public:
    explicit OverlapPasses(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device))
        , mConstants(gl::Buffer::create(mDevice, "lamina overlap constants")) {}

    /// Errors: OutOfMemory.
    [[nodiscard]] Result<void> initialize();

    /// Uploads the constants of all dispatches. The caller has saved the compute and unpack state;
    /// `sources` is borrowed until the last run().
    void begin(std::span<const OverlapSource> sources, std::span<const GridPart> parts,
               const GridTransform& transform);
    /// All triangles into part number `part`. What shaders write is then visible to shaders.
    /// gate: dispatches to use instead of smallGroups(), one for each chunk.
    void run(const OverlapPrograms& programs, std::size_t part, const DispatchGate& gate = {});
    /// Work groups along x of the programs for small triangles, a dispatch for each chunk.
    [[nodiscard]] std::vector<GLuint> smallGroups() const;

    /// Are there triangles at all?
    [[nodiscard]] bool hasTriangles() const { return !mChunks.empty(); }

private:
    /// What one dispatch binds besides the grid.
    struct Chunk {
        std::size_t source = 0;
        std::uint64_t firstTriangle = 0;
        std::uint64_t triangles = 0;
    };

    void uploadConstants(std::span<const GridPart> parts, const GridTransform& transform);
    void resetQueue();
    /// Binds what a chunk needs.
    void bind(const Chunk& chunk, std::size_t constantsIndex);
    void dispatchLarge(const OverlapPrograms& programs);

    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Buffer mConstants;
    gl::Buffer mQueue;
    std::span<const OverlapSource> mSources;
    std::vector<Chunk> mChunks;
    std::vector<std::byte> mConstantBytes;
    std::size_t mConstantStride = 0;
};

} // namespace lamina
