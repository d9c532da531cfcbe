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

/// Runs such programs over every triangle of the sources and every part of a grid.
class OverlapPasses {
public:
    explicit OverlapPasses(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device))
        , mConstants(gl::Buffer::create(mDevice, "lamina overlap constants")) {}

    /// Errors: OutOfMemory.
    [[nodiscard]] Result<void> initialize();

    /// Uploads the constants of all dispatches and binds the queue. The caller has saved the
    /// compute and unpack state; `sources` is borrowed until the last run().
    void begin(std::span<const OverlapSource> sources, std::span<const GridPart> parts,
               const GridTransform& transform);
    /// All triangles into part number `part`. What shaders write is then visible to shaders.
    void run(const OverlapPrograms& programs, std::size_t part);

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
    void dispatch(const OverlapPrograms& programs, const Chunk& chunk, std::size_t constantsIndex);

    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Buffer mConstants;
    gl::Buffer mQueue;
    std::span<const OverlapSource> mSources;
    std::vector<Chunk> mChunks;
    std::vector<std::byte> mConstantBytes;
    std::size_t mConstantStride = 0;
};

} // namespace lamina
