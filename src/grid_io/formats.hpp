#pragma once

#include "grid_io/box_voxels.hpp"

#include <lamina/grid_io/atomic_file.hpp>
#include <lamina/grid_io/grid_file.hpp>

#include <bit>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>

/// One function a format and direction. Writers append to a fresh file that the caller commits;
/// readers get the whole file and may assume nothing about it.
namespace lamina::detail {

Result<void> writeBinvox(AtomicFile& file, const BoxVoxels& voxels,
                         const GridWriteOptions& options);
Result<void> writeVox(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options);
/// What a .npy file holds: a byte for each voxel, or a row for each set voxel.
enum class NpyArray : std::uint8_t { Occupancy, Color, Normal };
Result<void> writeNpy(AtomicFile& file, const BoxVoxels& voxels, NpyArray array,
                      const GridWriteOptions& options);
Result<void> writeVti(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options);
Result<void> writeVdb(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options);

/// `bytes`: the file's content; `path` is for messages.
Result<BitGrid> readBinvox(std::span<const std::byte> bytes, const std::filesystem::path& path);
Result<BitGrid> readNpy(std::span<const std::byte> bytes, const std::filesystem::path& path);

/// Whole content of a regular file.
/// Errors: NotFound, InputOutput, OutOfMemory.
Result<std::vector<std::byte>> readFile(const std::filesystem::path& path);

/// The shortest text that reads back as the same number, with a point as decimal separator.
std::string exactText(double value);

/// "read grid 'NAME': DETAIL" as InvalidFile.
Error invalidFile(const std::filesystem::path& path, const std::string& detail);

/// Errors: Cancelled, if the callback ends the work.
inline Result<void> report(const GridWriteOptions& options, double fraction) {
    if (!options.progress || options.progress(fraction))
        return {};
    return Error{ErrorCode::Cancelled, "write grid: cancelled by the progress callback after " +
                                           std::to_string(std::lround(100.0 * fraction)) + " %"};
}

/// The options for a part of the work, from fraction `begin` to `end` of the whole. `options` must
/// outlive it.
inline GridWriteOptions partOf(const GridWriteOptions& options, double begin, double end) {
    GridWriteOptions part = options;
    if (options.progress)
        part.progress = [&options, begin, end](double fraction) {
            return options.progress(std::lerp(begin, end, fraction));
        };
    return part;
}

/// Calls visit(index) for each bit of a row that is set, in order.
template<class Visitor>
void forEachBit(std::span<const std::uint32_t> row, Visitor&& visit) {
    for (std::size_t w = 0; w < row.size(); ++w)
        for (std::uint32_t bits = row[w]; bits != 0; bits &= bits - 1)
            visit(static_cast<std::uint32_t>(32 * w) +
                  static_cast<std::uint32_t>(std::countr_zero(bits)));
}

/// Slices of the slowest axis that a writer loads at once: the step of BitGrid's words.
inline constexpr std::uint32_t kSlabSlices = 32;

/// Calls visit(rows of words, middle index, slow index) for every row of the grid in file order and
/// reports progress. Stops at the first error that visit() returns, or when cancelled.
template<class Visitor>
Result<void> forEachRow(const BoxVoxels& voxels, AxisOrder order, const GridWriteOptions& options,
                        Visitor&& visit) {
    const glm::uvec3 size{voxels.size()[order.fast], voxels.size()[order.middle],
                          voxels.size()[order.slow]};
    BitBlock block;
    for (std::uint32_t base = 0; base < size.z; base += kSlabSlices) {
        const std::uint32_t slices = std::min(kSlabSlices, size.z - base);
        voxels.load(order, {0, 0, base}, {size.x, size.y, slices}, block);
        for (std::uint32_t s = 0; s < slices; ++s)
            for (std::uint32_t m = 0; m < size.y; ++m)
                if (Result<void> visited = visit(block.row(m, s), m, base + s); !visited)
                    return visited;
        if (auto goesOn = report(options, static_cast<double>(base + slices) / size.z); !goesOn)
            return goesOn;
    }
    return {};
}

} // namespace lamina::detail
