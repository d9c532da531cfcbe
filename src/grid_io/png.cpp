#include <lamina/grid_io/image.hpp>

#include "grid_io/formats.hpp"

#include <lamina/grid_io/atomic_file.hpp>

#include <cstring>
#include <new>
#include <png.h>
#include <string>

namespace lamina {
namespace {

/// libpng's whole-image interface, which needs neither long jumps nor callbacks.
struct PngImage {
    png_image state;

    PngImage() {
        std::memset(&state, 0, sizeof state);
        state.version = PNG_IMAGE_VERSION;
    }
    ~PngImage() { png_image_free(&state); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

bool isOpaque(const Image& image) {
    for (std::size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255)
            return false;
    return true;
}

std::vector<std::uint8_t> withoutAlpha(const Image& image) {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(image.rgba.size() / 4 * 3);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
        rgb.insert(rgb.end(), {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]});
    return rgb;
}

Result<std::vector<std::byte>> encode(const Image& image) {
    PngImage png;
    png.state.width = image.width;
    png.state.height = image.height;
    const bool opaque = isOpaque(image);
    png.state.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    const std::vector<std::uint8_t> rgb =
        opaque ? withoutAlpha(image) : std::vector<std::uint8_t>();
    const std::uint8_t* pixels = opaque ? rgb.data() : image.rgba.data();
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png.state);
    std::vector<std::byte> encoded(bytes);
    if (!png_image_write_to_memory(&png.state, encoded.data(), &bytes, 0, pixels, 0, nullptr))
        return Error{ErrorCode::InvalidArgument,
                     std::string("write png: expected libpng to encode ") +
                         std::to_string(image.width) + " x " + std::to_string(image.height) +
                         " pixels, found: " + png.state.message};
    encoded.resize(bytes);
    return encoded;
}

Result<Image> decode(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    const auto invalid = [&](const std::string& found) {
        return Error{ErrorCode::InvalidFile,
                     "read png '" + path.string() + "': expected a PNG picture, found: " + found};
    };
    PngImage png;
    if (!png_image_begin_read_from_memory(&png.state, bytes.data(), bytes.size()))
        return invalid(png.state.message);
    // zlib compresses at most 1032 times and a pixel takes at least a bit: a header that claims
    // more lies.
    const double pixels = static_cast<double>(png.state.width) * png.state.height;
    if (pixels > 8.0 * 1032.0 * static_cast<double>(bytes.size()))
        return invalid("a header of " + std::to_string(png.state.width) + " x " +
                       std::to_string(png.state.height) + " pixels in " +
                       std::to_string(bytes.size()) + " bytes");
    png.state.format = PNG_FORMAT_RGBA;
    Image image{png.state.width, png.state.height, {}};
    image.rgba.resize(static_cast<std::size_t>(image.width) * image.height * 4);
    if (!png_image_finish_read(&png.state, nullptr, image.rgba.data(), 0, nullptr) ||
        PNG_IMAGE_FAILED(png.state))
        return invalid(png.state.message);
    return image;
}

} // namespace

Result<void> writePng(const std::filesystem::path& path, const Image& image) {
    const std::size_t expected = static_cast<std::size_t>(image.width) * image.height * 4;
    if (expected == 0 || image.rgba.size() != expected)
        return Error{ErrorCode::InvalidArgument, "write png '" + path.string() + "': expected " +
                                                     std::to_string(image.width) + " x " +
                                                     std::to_string(image.height) +
                                                     " x 4 bytes and at least one pixel, found " +
                                                     std::to_string(image.rgba.size()) + " bytes"};
    try {
        const auto encoded = encode(image);
        if (!encoded)
            return encoded.error();
        auto file = AtomicFile::create(path);
        if (!file)
            return file.error();
        if (auto written = file->write(*encoded); !written)
            return written;
        return file->commit();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "write png '" + path.string() +
                         "': expected memory to encode it, found too little"};
    }
}

Result<Image> readPng(const std::filesystem::path& path) {
    try {
        const auto bytes = detail::readFile(path);
        return bytes ? decode(*bytes, path) : Result<Image>(bytes.error());
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "read png '" + path.string() +
                         "': expected memory for its pixels, found too little"};
    }
}

} // namespace lamina
