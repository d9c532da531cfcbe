#pragma once

#include "gl/device_state.hpp"

#include <lamina/grid/voxel_grid.hpp>

#include <array>

namespace lamina {

/// Ranks of the set voxels of a grid, as lamina/voxel_rank.glsl reads them.
struct VoxelRanks {
    gl::Buffer buffer;
    gl::Texture texture; ///< The buffer as a texel buffer.
    std::uint64_t blocks = 0;

    /// Where the number of set voxels stands in the buffer, bytes.
    [[nodiscard]] std::uint64_t totalOffsetBytes() const;
};

/// Makes VoxelRanks: a prefix sum over the words of a grid.
class VoxelRanker {
public:
    explicit VoxelRanker(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device)) {}

    /// Errors: ShaderError.
    [[nodiscard]] Result<void> initialize();

    /// Makes room for the ranks of a grid. Errors: DeviceLimit, OutOfMemory; `ranks` is then
    /// unchanged.
    [[nodiscard]] Result<void> reserve(const GridTransform& transform, VoxelRanks& ranks) const;

    /// Fills `ranks`. The caller has saved the compute state, storage bindings 0 and 1, and has
    /// bound the grid to LAMINA_PASS_GRID_BLOCK_BINDING and texture unit 0. Ranks are then visible
    /// to texel fetches and to readBack().
    void rank(const VoxelGrid& grid, const VoxelRanks& ranks) const;

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    std::array<GLuint, 2> mPrograms{}; ///< By VoxelStore.
    GLuint mBlocksProgram = 0;
};

/// Number of set voxels, at most LAMINA_RANK_OVERFLOW. Waits for the GPU.
[[nodiscard]] std::uint32_t readVoxelCount(const gl::DeviceState& device, const VoxelRanks& ranks);

} // namespace lamina
