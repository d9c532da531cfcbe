#include "voxelize/solid_lines.hpp"

#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace lamina {
namespace {

constexpr std::array<SolidLine, LAMINA_SOLID_LINE_COUNT> kLines{
    SolidLine{LAMINA_SOLID_ALONG_X, {0, 0}},  SolidLine{LAMINA_SOLID_ALONG_Y, {0, 0}},
    SolidLine{LAMINA_SOLID_ALONG_Z, {0, 0}},  SolidLine{LAMINA_SOLID_ALONG_X, {1, 1}},
    SolidLine{LAMINA_SOLID_ALONG_X, {1, -1}}, SolidLine{LAMINA_SOLID_ALONG_X, {-1, 1}},
    SolidLine{LAMINA_SOLID_ALONG_X, {-1, -1}}};

/// More cells at a time save passes over the geometry, which cost less than the cells.
constexpr std::uint64_t kMaxCellBytes = std::uint64_t{512} << 20u;
constexpr std::uint32_t kCellBytes = 16;
/// Rays start this far from voxel centres, in voxels, so that all rays of a centre on a surface
/// find it on the same side: the one that SolidRule::Parity takes, z before x before y. More than
/// the rounding of doubles, less than a millionth of the voxels could tell.
const glm::dvec3 kNudge{0x1p-26, -0x1p-34, 0x1p-18};

/// Axes of the grid along P, Q, S.
glm::ivec3 axesOf(const SolidLine& line) {
    switch (line.along) {
    case LAMINA_SOLID_ALONG_X:
        return {1, 2, 0};
    case LAMINA_SOLID_ALONG_Y:
        return {0, 2, 1};
    default:
        return {1, 0, 2};
    }
}

glm::ivec3 sizeAlong(const SolidLine& line, const glm::uvec3& size) {
    const glm::ivec3 axes = axesOf(line);
    return {size[axes.x], size[axes.y], size[axes.z]};
}

int roundedUp(int value, int step) {
    return (value + step - 1) / step * step;
}

} // namespace

std::span<const SolidLine> solidLines() {
    return kLines;
}

shared::LaminaSolidLine SolidCells::batch(std::uint32_t index) const {
    shared::LaminaSolidLine block = constants;
    const std::uint32_t first = index * rowsPerBatch;
    block.rows.x = static_cast<int>(first);
    block.rows.y = static_cast<int>(std::min(rowsPerBatch, rows() - first));
    return block;
}

Result<SolidCells> solidCells(const gl::DeviceState& device, const SolidLine& line,
                              const glm::uvec3& size) {
    const std::uint64_t limit = std::min(device.limits.maxStorageBlockBytes, kMaxCellBytes);
    const glm::ivec3 counts = sizeAlong(line, size);
    SolidCells cells;
    cells.constants.grid = glm::ivec4(counts, 0);
    cells.constants.slope = {line.slope, 0, 0};
    cells.constants.rows.z = line.along;
    // What a line crosses before its first voxel takes a slot or a bit of its own; around the grid
    // of a diagonal there is a voxel of margin.
    if (line.along == LAMINA_SOLID_ALONG_Z) {
        const int bits = roundedUp(counts.z + 1, 32);
        cells.constants.period = {counts.x, bits, counts.y, bits / 32};
        cells.constants.rows.w = roundedUp(bits / 32, 32) / 32;
    } else if (line.slope == glm::ivec2(0)) {
        const int bits = roundedUp(counts.y, 32);
        cells.constants.period = {counts.x, bits, counts.z + 1, bits / 32};
        cells.constants.rows.w = roundedUp(counts.z + 1, 32) / 32;
    } else {
        const int rows = counts.x + 2;
        const int bits = roundedUp(counts.y + 2, 32);
        const int slots = counts.z + 2;
        cells.constants.period = {rows, bits, slots, bits / 32};
        cells.constants.slope.z = roundedUp(slots, rows);
        cells.constants.slope.w = roundedUp(slots, bits);
    }
    const glm::ivec4& period = cells.constants.period;
    cells.rowBytes = std::uint64_t{kCellBytes} * static_cast<std::uint64_t>(period.z) *
                     static_cast<std::uint64_t>(period.w);
    cells.rowsPerBatch = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(limit / cells.rowBytes, static_cast<std::uint64_t>(period.x)));
    if (cells.rowsPerBatch == 0)
        return Error{ErrorCode::DeviceLimit,
                     "voxelize: grid " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                         " x " + std::to_string(size.z) + ": solid rule voted needs " +
                         std::to_string(cells.rowBytes) +
                         " bytes for a plane of voxels, the device's limit is " +
                         std::to_string(limit) + "; use a smaller grid or SolidRule::Parity"};
    return cells;
}

glm::dmat4 gridToLines(const SolidLine& line) {
    const glm::ivec3 axes = axesOf(line);
    // p = P - slope (S - 1/2): centres of voxels stay centres of columns.
    glm::dmat4 matrix(0.0);
    matrix[axes.x][0] = matrix[axes.y][1] = matrix[axes.z][2] = matrix[3][3] = 1.0;
    for (int i = 0; i < 2; ++i) {
        matrix[axes.z][i] = -line.slope[i];
        matrix[3][i] = 0.5 * line.slope[i];
    }
    return glm::translate(matrix, -kNudge);
}

std::vector<GridPart> linesParts(const SolidLine& line, const glm::uvec3& size,
                                 const shared::LaminaSolidLine& batch) {
    const glm::ivec3 counts = sizeAlong(line, size);
    const glm::ivec2 reach = line.slope * (counts.z - 1);
    GridPart all;
    all.low = glm::ivec3(-glm::max(reach, 0), 0);
    all.high = {counts.x - 1 - std::min(reach.x, 0), counts.y - 1 - std::min(reach.y, 0),
                counts.z - 1};
    // Line p has row p of an axis, p + 1 - slope modulo the period of a diagonal. Where that would
    // take many parts, the programs reject the other lines.
    constexpr int kMostParts = 4;
    const int period = batch.period.x;
    if (batch.rows.y == period || all.high.x - all.low.x + 1 > (kMostParts - 1) * period)
        return {all};
    int first = batch.rows.x - (line.slope == glm::ivec2(0) ? 0 : 1 - line.slope.x);
    while (first > all.low.x)
        first -= period;
    std::vector<GridPart> parts;
    for (; first <= all.high.x; first += period) {
        GridPart part = all;
        part.low.x = std::max(all.low.x, first);
        part.high.x = std::min(all.high.x, first + batch.rows.y - 1);
        if (part.low.x <= part.high.x)
            parts.push_back(part);
    }
    return parts;
}

} // namespace lamina
