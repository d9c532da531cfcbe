#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace lamina {

/// A picture: 8-bit sRGB colours with straight (not premultiplied) linear alpha.
struct Image {
    std::uint32_t width = 0;        ///< Pixels.
    std::uint32_t height = 0;       ///< Pixels.
    std::vector<std::uint8_t> rgba; ///< width * height * 4 bytes, rows from the top.

    /// The four bytes of a pixel inside the picture; (0,0) is the upper left.
    [[nodiscard]] std::span<const std::uint8_t, 4> pixel(std::uint32_t x, std::uint32_t y) const {
        const std::size_t index = (static_cast<std::size_t>(y) * width + x) * 4;
        return std::span<const std::uint8_t, 4>(rgba.data() + index, 4);
    }
};

/// Writes a PNG that appears whole or not at all; without alpha channel where all is opaque.
/// Errors: InvalidArgument (no pixels, or rgba of another size), NotFound, InputOutput (see
/// AtomicFile), OutOfMemory.
[[nodiscard]] LAMINA_API Result<void> writePng(const std::filesystem::path& path,
                                               const Image& image);

/// Reads any PNG, converted to 8-bit sRGB with alpha.
/// Errors: NotFound, InputOutput, InvalidFile (with libpng's reason), OutOfMemory.
[[nodiscard]] LAMINA_API Result<Image> readPng(const std::filesystem::path& path);

} // namespace lamina
