#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamina::detail {

/// Colours that a .vox file holds; index 0 of its 256 means empty.
inline constexpr std::size_t kPaletteColors = 255;

/// A few colours that stand for many. Colours are 24-bit numbers, red lowest.
class Palette {
public:
    /// One colour, for voxels that have none of their own.
    [[nodiscard]] static Palette single(std::uint32_t color) {
        Palette palette;
        palette.mColors = {color};
        return palette;
    }

    [[nodiscard]] const std::vector<std::uint32_t>& colors() const { return mColors; }
    /// The place in colors() of what stands for `color`, which was added to the builder.
    [[nodiscard]] std::size_t index(std::uint32_t color) const { return mIndices[color]; }

private:
    friend class PaletteBuilder;

    std::vector<std::uint32_t> mColors;
    std::vector<std::uint8_t> mIndices; ///< By colour.
};

/// Counts colours and chooses a palette. Memory: 64 MiB, and 8 bytes a different colour.
class PaletteBuilder {
public:
    PaletteBuilder();

    /// Counts one voxel of a colour.
    void add(std::uint32_t color) { ++mCounts[color]; }

    /// At most `size` colours (1 to 255): all that were added if so many suffice. Otherwise boxes
    /// of the colour cube, each cut in two at its mean along its longest variance, the one whose
    /// colours err most first, until there are `size`; the mean of each stands for its colours.
    [[nodiscard]] Palette build(std::size_t size) const;

private:
    std::vector<std::uint32_t> mCounts; ///< By colour.
};

} // namespace lamina::detail
