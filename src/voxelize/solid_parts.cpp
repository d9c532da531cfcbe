#include "voxelize/solid_parts.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace lamina {
namespace {

/// A scan or a sweep passes twice along an axis in one invocation, which may loop 65,535 times
/// (llvmpipe); and dispatches are limited so.
constexpr std::uint32_t kMaxSide = 16384;

/// Along x, y and the layers.
glm::uvec3 tilesOf(const GridPart& part) {
    constexpr int kGroup = LAMINA_OVERLAP_GROUP_SIZE;
    return {(part.high.x + kGroup) / kGroup, part.high.y - part.low.y + 1, part.layers()};
}

} // namespace

std::uint64_t tileCount(const GridPart& part) {
    const glm::uvec3 tiles = tilesOf(part);
    return std::uint64_t{tiles.x} * tiles.y * tiles.z;
}

shared::uvec4 texelGroups(const GridPart& part) {
    return {tilesOf(part), 0};
}

Result<void> checkSolidSize(const glm::uvec3& size, SolidRule rule) {
    if (std::max({size.x, size.y, size.z}) <= kMaxSide)
        return {};
    return Error{ErrorCode::DeviceLimit,
                 "voxelize: grid " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                     " x " + std::to_string(size.z) + ", the limit of solid rule " +
                     std::string(name(rule)) + " is " + std::to_string(kMaxSide) +
                     " voxels along an axis; use a smaller grid or SolidRule::Parity"};
}

void SolidParts::begin(std::span<const GridPart> parts, const GridTransform& transform,
                       std::span<const shared::uvec4> dispatches) {
    mParts = parts;
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mConstantStride = (sizeof(shared::LaminaSolidPart) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> constants(mConstantStride * parts.size());
    std::uint64_t tiles = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const shared::LaminaSolidPart block{glm::ivec4(parts[i].low, parts[i].skippedTexels),
                                            glm::ivec4(parts[i].high, i),
                                            glm::ivec4(transform.size(), tiles)};
        tiles += tileCount(parts[i]);
        std::memcpy(constants.data() + i * mConstantStride, &block, sizeof block);
    }
    std::vector<GLuint> tally(LAMINA_TALLY_DISPATCHES, 0);
    for (const shared::uvec4& dispatch : dispatches)
        tally.insert(tally.end(), {dispatch.x, dispatch.y, dispatch.z, dispatch.w});
    const GladGLContext& gl = mDevice->gl;
    // New storage each time: dispatches of the last call may still use the old.
    gl.NamedBufferData(mConstants.id(), static_cast<GLsizeiptr>(constants.size()), constants.data(),
                       GL_STREAM_DRAW);
    gl.NamedBufferData(mTally.id(), static_cast<GLsizeiptr>(tally.size() * sizeof(GLuint)),
                       tally.data(), GL_DYNAMIC_COPY);
    const GLuint id = mTally.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_TALLY_BINDING, 1, &id);
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, id);
    mHasReport = true;
}

void SolidParts::dispatchTexels(std::size_t part) const {
    const shared::uvec4 groups = texelGroups(mParts[part]);
    mDevice->gl.DispatchCompute(groups.x, groups.y, groups.z);
}

void SolidParts::bind(std::size_t part, GLuint words) const {
    const GLuint constants = mConstants.id();
    const auto offset = static_cast<GLintptr>(part * mConstantStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaSolidPart);
    mDevice->gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_SOLID_PART_BINDING, 1, &constants,
                                 &offset, &kBytes);
    bindRange(part, LAMINA_OVERLAP_WORDS_BINDING, words, 0);
}

void SolidParts::bindRange(std::size_t part, GLuint binding, GLuint buffer,
                           std::uint64_t offsetBytes) const {
    const GLintptr offset = mParts[part].offsetBytes + static_cast<GLintptr>(offsetBytes);
    mDevice->gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, binding, 1, &buffer, &offset,
                                 &mParts[part].sizeBytes);
}

Result<SolidReport> SolidParts::download() const {
    if (!mHasReport)
        return Error{ErrorCode::InvalidArgument,
                     "solid report: expected voxels, found none; voxelize first"};
    std::array<GLuint, LAMINA_TALLY_SUMS> tally{};
    mDevice->gl.GetNamedBufferSubData(mTally.id(), 0, sizeof tally, tally.data());
    const auto number = [&tally](std::size_t index) {
        return tally[index] | std::uint64_t{tally[index + 1]} << 32u;
    };
    SolidReport report;
    report.doubtfulVoxels = number(LAMINA_TALLY_DOUBTFUL);
    report.enclosedVoxels = number(LAMINA_TALLY_ENCLOSED);
    report.isFloodComplete = tally[LAMINA_TALLY_CHANGED] == 0;
    return report;
}

bool SolidParts::downloadIsContested() const {
    GLuint isContested = 0;
    mDevice->gl.GetNamedBufferSubData(mTally.id(), LAMINA_TALLY_CONTESTED * sizeof(GLuint),
                                      sizeof isContested, &isContested);
    return isContested != 0;
}

} // namespace lamina
