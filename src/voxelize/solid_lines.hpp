#pragma once

#include "gl/device_state.hpp"
#include "voxelize/overlap_grid.hpp"
#include "voxelize/solid_constants.hpp"

#include <lamina/core/result.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// A direction along which SolidRule::Voted counts crossings (LaminaSolidLine).
struct SolidLine {
    int along = LAMINA_SOLID_ALONG_X; ///< LAMINA_SOLID_ALONG_*: the axis of its steps.
    glm::ivec2 slope{0};              ///< Voxels along P and Q from one step to the next.
};

/// The three axes of the grid, then its four diagonals.
[[nodiscard]] std::span<const SolidLine> solidLines();

/// The cells of a line, in batches of rows that a storage binding holds.
struct SolidCells {
    shared::LaminaSolidLine constants{}; ///< But for the rows of a batch.
    std::uint64_t rowBytes = 0;
    std::uint32_t rowsPerBatch = 0;

    [[nodiscard]] std::uint32_t rows() const {
        return static_cast<std::uint32_t>(constants.period.x);
    }
    [[nodiscard]] std::uint32_t batches() const {
        return (rows() + rowsPerBatch - 1) / rowsPerBatch;
    }
    [[nodiscard]] bool isAlongWords() const { return constants.rows.z == LAMINA_SOLID_ALONG_Z; }
    /// Invocations of the program that scans a batch.
    [[nodiscard]] std::uint64_t scans(std::uint32_t index) const {
        return static_cast<std::uint64_t>(batch(index).rows.y) * scansPerRow();
    }
    [[nodiscard]] std::uint64_t bytes(std::uint32_t index) const {
        return rowBytes * static_cast<std::uint64_t>(batch(index).rows.y);
    }
    /// Of the touched bits of a batch.
    [[nodiscard]] std::uint64_t touchedBytes() const {
        return rowsPerBatch * scansPerRow() * static_cast<std::uint64_t>(constants.rows.w) *
               sizeof(std::uint32_t);
    }
    /// The constants of a batch.
    [[nodiscard]] shared::LaminaSolidLine batch(std::uint32_t index) const;

private:
    [[nodiscard]] std::uint64_t scansPerRow() const {
        return static_cast<std::uint64_t>(isAlongWords() ? constants.period.z : constants.period.w);
    }
};

/// size: of the grid, in voxels.
/// Errors: DeviceLimit (a row too large for a binding).
[[nodiscard]] Result<SolidCells> solidCells(const gl::DeviceState& device, const SolidLine& line,
                                            const glm::uvec3& size);

/// Grid coordinates to (p, q, s): lines become columns, steps become slices.
[[nodiscard]] glm::dmat4 gridToLines(const SolidLine& line);

/// The columns of the lines that meet the grid and whose cells are those of a batch, as parts for
/// OverlapPasses.
[[nodiscard]] std::vector<GridPart> linesParts(const SolidLine& line, const glm::uvec3& size,
                                               const shared::LaminaSolidLine& batch);

} // namespace lamina
