#include "voxelize/voxel_ranks.hpp"

#include "gl/program_cache.hpp"
#include "voxelize/attribute_constants.hpp"

#include <algorithm>
#include <string>

namespace lamina {
namespace {

constexpr std::uint64_t kBlockTexels = LAMINA_RANK_BLOCK_TEXELS;
constexpr std::uint64_t kRankBytes = sizeof(std::uint32_t);
constexpr std::uint64_t kBlockBytes = kBlockTexels * kRankBytes;
/// The limit of GL_MAX_COMPUTE_WORK_GROUP_COUNT that every device has.
constexpr std::uint64_t kMaxGroups = 65535;

std::uint64_t texelCount(const GridTransform& transform) {
    const glm::uvec3 size = transform.size();
    return std::uint64_t{size.x} * size.y *
           ((size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup);
}

} // namespace

std::uint64_t VoxelRanks::totalOffsetBytes() const {
    return blocks * kBlockBytes + blocks * kRankBytes;
}

Result<void> VoxelRanker::initialize() {
    for (std::size_t store = 0; store < mPrograms.size(); ++store) {
        auto program = gl::findOrBuildProgram(
            *mDevice, {"lamina ranks",
                       {{GL_COMPUTE_SHADER, "voxelize/rank.comp"}},
                       {{"LAMINA_GRID_BUFFER_STORE", std::to_string(store)}}});
        if (!program)
            return program.error();
        mPrograms[store] = *program;
    }
    auto program = gl::findOrBuildProgram(
        *mDevice, {"lamina rank blocks", {{GL_COMPUTE_SHADER, "voxelize/rank_blocks.comp"}}, {}});
    if (!program)
        return program.error();
    mBlocksProgram = *program;
    return {};
}

Result<void> VoxelRanker::reserve(const GridTransform& transform, VoxelRanks& ranks) const {
    const std::uint64_t blocks = (texelCount(transform) + kBlockTexels - 1) / kBlockTexels;
    const std::uint64_t ranksNeeded = blocks * kBlockTexels + blocks + 1;
    const std::string operation = "voxel ranks of " + transform.describe();
    if (ranksNeeded > mDevice->limits.maxTextureBufferTexels)
        return Error{ErrorCode::DeviceLimit,
                     operation + ": needs a texel buffer of " + std::to_string(ranksNeeded) +
                         " texels, the device's limit is " +
                         std::to_string(mDevice->limits.maxTextureBufferTexels) +
                         "; use a smaller grid"};
    if (ranks.blocks == blocks)
        return {};
    auto buffer = gl::createBuffer(mDevice, ranksNeeded * kRankBytes, nullptr, 0, operation,
                                   "lamina voxel ranks");
    if (!buffer)
        return buffer.error();
    ranks.texture = gl::Texture::create(mDevice, "lamina voxel ranks", GL_TEXTURE_BUFFER);
    ranks.buffer = std::move(*buffer);
    ranks.blocks = blocks;
    mDevice->gl.TextureBuffer(ranks.texture.id(), GL_R32UI, ranks.buffer.id());
    return {};
}

void VoxelRanker::rank(const VoxelGrid& grid, const VoxelRanks& ranks) const {
    const GladGLContext& gl = mDevice->gl;
    const GLuint buffer = ranks.buffer.id();
    const auto bind = [&](GLuint binding, std::uint64_t firstByte, std::uint64_t bytes) {
        const auto offset = static_cast<GLintptr>(firstByte);
        const auto size = static_cast<GLsizeiptr>(bytes);
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, binding, 1, &buffer, &offset, &size);
    };
    const GLuint program = mPrograms[static_cast<std::size_t>(grid.store())];
    bind(LAMINA_RANK_BLOCKS_BINDING, ranks.blocks * kBlockBytes, (ranks.blocks + 1) * kRankBytes);
    gl.UseProgram(program);
    // A power of two, so that offsets are aligned.
    const std::uint64_t step = std::uint64_t{1} << 16u;
    const std::uint64_t most = std::min(step, mDevice->limits.maxStorageBlockBytes / kBlockBytes);
    for (std::uint64_t first = 0; first < ranks.blocks; first += most) {
        const std::uint64_t count = std::min(most, ranks.blocks - first);
        bind(LAMINA_RANK_TEXELS_BINDING, first * kBlockBytes, count * kBlockBytes);
        gl.ProgramUniform1i(program, 0, static_cast<GLint>(first));
        gl.ProgramUniform1i(program, 1, static_cast<GLint>(first + count));
        gl.DispatchCompute(static_cast<GLuint>(std::min(count, kMaxGroups)),
                           static_cast<GLuint>((count + kMaxGroups - 1) / kMaxGroups), 1);
    }
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    gl.UseProgram(mBlocksProgram);
    gl.ProgramUniform1i(mBlocksProgram, 0, static_cast<GLint>(ranks.blocks));
    gl.DispatchCompute(1, 1, 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

std::uint32_t readVoxelCount(const gl::DeviceState& device, const VoxelRanks& ranks) {
    std::uint32_t count = 0;
    device.gl.GetNamedBufferSubData(
        ranks.buffer.id(), static_cast<GLintptr>(ranks.totalOffsetBytes()), sizeof count, &count);
    return count;
}

} // namespace lamina
