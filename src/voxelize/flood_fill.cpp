#include "voxelize/flood_fill.hpp"

#include "gl/program_cache.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace lamina {
namespace {

/// Dispatches of a part in a round: along columns, along x, along y.
constexpr std::size_t kDispatchesPerPart = 3;

/// Where the dispatch of a part along columns (0), x (1) or y (2) is.
GLintptr dispatchOffset(std::size_t part, std::size_t which) {
    return SolidParts::dispatchOffset(part * kDispatchesPerPart + which);
}

/// An indirect dispatch of that many invocations along x.
shared::uvec4 groupsOf(int invocations, int y) {
    constexpr int kGroup = LAMINA_OVERLAP_GROUP_SIZE;
    return {(invocations + kGroup - 1) / kGroup, y, 1, 0};
}

} // namespace

Result<void> FloodFill::initialize() {
    const auto build = [this](GLuint& program, const char* shader) -> Result<void> {
        auto built = gl::findOrBuildProgram(
            *mDevice, {"lamina flood fill", {{GL_COMPUTE_SHADER, shader}}, {}});
        if (!built)
            return built.error();
        program = *built;
        return {};
    };
    for (const auto& built : {build(mSeedProgram, "voxelize/flood_seed.comp"),
                              build(mColumnsProgram, "voxelize/flood_columns.comp"),
                              build(mRowsProgram, "voxelize/flood_rows.comp"),
                              build(mRoundProgram, "voxelize/flood_round.comp"),
                              build(mEndProgram, "voxelize/flood_end.comp")})
        if (!built)
            return built;
    return {};
}

Result<void> FloodFill::reserve(const GridTransform& transform, std::span<const GridPart> parts) {
    const glm::uvec3 size = transform.size();
    if (auto fits = checkSolidSize(size, SolidRule::FloodFill); !fits)
        return fits;
    // A sweep along y carries nothing from part to part.
    if (parts.front().high.y + 1 < static_cast<int>(size.y))
        return Error{ErrorCode::DeviceLimit,
                     "voxelize: grid " + transform.describe() +
                         ", the limit of SolidRule::FloodFill is as many columns as fit " +
                         std::to_string(mDevice->limits.maxStorageBlockBytes) +
                         " bytes, 16 each; use fewer columns or SolidRule::Voted"};
    std::uint64_t bytes = 0;
    for (const GridPart& part : parts)
        bytes = std::max(bytes, static_cast<std::uint64_t>(part.offsetBytes + part.sizeBytes));
    const std::uint64_t carryBytes = std::uint64_t{size.x} * size.y * sizeof(GLuint);
    if (mOutside.bytes() < bytes) {
        auto outside = gl::createBuffer(mDevice, bytes, nullptr, 0, "voxelize: solid by flood fill",
                                        "lamina flood outside");
        if (!outside)
            return outside.error();
        mOutside = std::move(*outside);
    }
    if (mCarry.bytes() < carryBytes) {
        auto carry = gl::createBuffer(mDevice, carryBytes, nullptr, 0,
                                      "voxelize: solid by flood fill", "lamina flood carry");
        if (!carry)
            return carry.error();
        mCarry = std::move(*carry);
    }
    return {};
}

void FloodFill::bind(std::size_t part, GLuint words) const {
    mParts.bind(part, words);
    mParts.bindRange(part, LAMINA_FLOOD_OUTSIDE_BINDING, mOutside.id(), 0);
}

void FloodFill::dispatchWords(GLuint program, GLuint words) const {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(program);
    for (std::size_t part = 0; part < mParts.count(); ++part) {
        bind(part, words);
        mParts.dispatchTexels(part);
    }
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FloodFill::sweepColumns(GLuint words, bool up) const {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(mColumnsProgram);
    gl.ProgramUniform1i(mColumnsProgram, 0, up ? 1 : 0);
    for (std::size_t i = 0; i < mParts.count(); ++i) {
        const std::size_t part = up ? i : mParts.count() - 1 - i;
        bind(part, words);
        gl.DispatchComputeIndirect(dispatchOffset(part, 0));
        // The next part goes on where this one ended.
        gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
}

void FloodFill::sweepRows(GLuint words, int axis) const {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(mRowsProgram);
    gl.ProgramUniform1i(mRowsProgram, 0, axis);
    for (std::size_t part = 0; part < mParts.count(); ++part) {
        bind(part, words);
        gl.DispatchComputeIndirect(dispatchOffset(part, static_cast<std::size_t>(axis) + 1));
    }
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void FloodFill::run(std::span<const GridPart> parts, const GridTransform& transform, GLuint words) {
    const GladGLContext& gl = mDevice->gl;
    std::vector<shared::uvec4> dispatches;
    for (const GridPart& part : parts) {
        const glm::ivec3 counts = part.high - part.low + 1;
        dispatches.push_back(groupsOf(counts.x, counts.y));
        dispatches.push_back(groupsOf(counts.y, part.layers()));
        dispatches.push_back(groupsOf(counts.x, part.layers()));
    }
    mParts.begin(parts, transform, dispatches);
    const GLuint carry = mCarry.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_FLOOD_CARRY_BINDING, 1, &carry);
    dispatchWords(mSeedProgram, words);
    gl.ProgramUniform1i(mRoundProgram, 0, static_cast<GLint>(dispatches.size()));
    for (int round = 1; round <= LAMINA_FLOOD_ROUNDS; ++round) {
        sweepColumns(words, true);
        sweepColumns(words, false);
        sweepRows(words, 0);
        sweepRows(words, 1);
        gl.UseProgram(mRoundProgram);
        gl.ProgramUniform1i(mRoundProgram, 1, round == LAMINA_FLOOD_ROUNDS ? 1 : 0);
        gl.DispatchCompute(1, 1, 1);
        gl.MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    }
    dispatchWords(mEndProgram, words);
}

} // namespace lamina
