#include "grid_io/formats.hpp"

#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

namespace lamina::detail {
namespace {

constexpr std::string_view kMagic{"\x93NUMPY", 6};

/// The Python dictionary in front of the data, parsed as far as NumPy writes it.
class HeaderParser {
public:
    explicit HeaderParser(std::string_view text)
        : mText(text) {}

    std::string descr;
    std::optional<bool> fortranOrder;
    std::optional<std::vector<std::uint64_t>> shape;

    bool parse() {
        if (!accept('{'))
            return false;
        while (!accept('}')) {
            std::string key;
            if (!quoted(key) || !accept(':') || !value(key))
                return false;
            if (!accept(','))
                return accept('}') && atEnd();
        }
        return atEnd();
    }

private:
    bool value(const std::string& key) {
        if (key == "descr")
            return quoted(descr);
        if (key == "fortran_order") {
            fortranOrder = word("True");
            return *fortranOrder || word("False");
        }
        return key == "shape" && tuple();
    }

    bool tuple() {
        if (!accept('('))
            return false;
        shape.emplace();
        while (!accept(')')) {
            skipSpace();
            std::uint64_t number = 0;
            const auto [end, error] =
                std::from_chars(mText.data(), mText.data() + mText.size(), number);
            if (error != std::errc())
                return false;
            mText.remove_prefix(static_cast<std::size_t>(end - mText.data()));
            shape->push_back(number);
            if (!accept(','))
                return accept(')');
        }
        return true;
    }

    bool quoted(std::string& out) {
        skipSpace();
        if (mText.empty() || (mText.front() != '\'' && mText.front() != '"'))
            return false;
        const std::size_t end = mText.find(mText.front(), 1);
        if (end == std::string_view::npos)
            return false;
        out = mText.substr(1, end - 1);
        mText.remove_prefix(end + 1);
        return true;
    }

    bool word(std::string_view expected) {
        skipSpace();
        if (!mText.starts_with(expected))
            return false;
        mText.remove_prefix(expected.size());
        return true;
    }

    bool accept(char expected) { return word(std::string_view(&expected, 1)); }

    bool atEnd() {
        skipSpace();
        return mText.empty();
    }

    void skipSpace() {
        while (!mText.empty() && (mText.front() == ' ' || mText.front() == '\n'))
            mText.remove_prefix(1);
    }

    std::string_view mText;
};

std::string text(const std::vector<std::uint64_t>& shape) {
    std::string result = "(";
    for (std::size_t i = 0; i < shape.size() && i < 8; ++i)
        result += (i ? ", " : "") + std::to_string(shape[i]);
    return result + (shape.size() > 8 ? ", ...)" : ")");
}

std::uint32_t byteAt(std::span<const std::byte> bytes, std::size_t index) {
    return std::to_integer<std::uint32_t>(bytes[index]);
}

Result<void> writeHeader(AtomicFile& file, std::string_view type,
                         const std::vector<std::uint64_t>& shape) {
    std::string header = "{'descr': '" + std::string(type) +
                         "', 'fortran_order': False, 'shape': " + text(shape) + ", }";
    // The data begins at a multiple of 64 bytes, after a line feed.
    const std::size_t prefix = kMagic.size() + 4;
    header.append(63 - (prefix + header.size()) % 64, ' ');
    header += '\n';
    std::string start(kMagic);
    start += {'\x01', '\x00', static_cast<char>(header.size() & 0xff),
              static_cast<char>(header.size() >> 8)};
    return file.write(start + header);
}

/// A row for each set voxel in C order: valueOf(voxel) as it is in memory.
template<class ValueOf>
Result<void> writeRows(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options,
                       ValueOf&& valueOf) {
    std::vector<decltype(valueOf(glm::uvec3(0)))> values;
    return forEachRow(voxels, {0, 1, 2}, options,
                      [&](std::span<const std::uint32_t> row, std::uint32_t y, std::uint32_t z) {
                          values.clear();
                          forEachBit(row, [&](std::uint32_t x) {
                              values.push_back(valueOf(glm::uvec3(x, y, z)));
                          });
                          return file.write(std::as_bytes(std::span(values)));
                      });
}

} // namespace

Result<void> writeNpy(AtomicFile& file, const BoxVoxels& voxels, NpyArray array,
                      const GridWriteOptions& options) {
    static_assert(std::endian::native == std::endian::little && sizeof(glm::vec3) == 12,
                  "normals are stored as they are");
    const glm::uvec3 size = voxels.size();
    if (array == NpyArray::Color) {
        if (auto written = writeHeader(file, "|u1", {voxels.count(), 4}); !written)
            return written;
        return writeRows(file, voxels, options,
                         [&](const glm::uvec3& voxel) { return voxels.color(voxel); });
    }
    if (array == NpyArray::Normal) {
        if (auto written = writeHeader(file, "<f4", {voxels.count(), 3}); !written)
            return written;
        return writeRows(file, voxels, options,
                         [&](const glm::uvec3& voxel) { return voxels.normal(voxel); });
    }
    if (auto written = writeHeader(file, "|u1", {size.z, size.y, size.x}); !written)
        return written;
    std::vector<std::uint8_t> bytes(size.x);
    return forEachRow(voxels, {0, 1, 2}, options,
                      [&](std::span<const std::uint32_t> row, std::uint32_t, std::uint32_t) {
                          expandBits(row, size.x, bytes.data());
                          return file.write(std::as_bytes(std::span(bytes)));
                      });
}

Result<BitGrid> readNpy(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    if (bytes.size() < 10 || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0)
        return invalidFile(
            path, "expected '\\x93NUMPY' at byte 0, found " +
                      std::string(bytes.size() < 10
                                      ? "a file of " + std::to_string(bytes.size()) + " bytes"
                                      : "other bytes"));
    const std::uint32_t version = byteAt(bytes, 6);
    if (version < 1 || version > 3)
        return invalidFile(path, "expected format version 1, 2 or 3 at byte 6, found " +
                                     std::to_string(version));
    const std::size_t lengthBytes = version == 1 ? 2 : 4;
    const std::size_t headerBegin = 8 + lengthBytes;
    std::size_t headerBytes = 0;
    for (std::size_t i = 0; i < lengthBytes && headerBegin <= bytes.size(); ++i)
        headerBytes |= static_cast<std::size_t>(byteAt(bytes, 8 + i)) << (8 * i);
    if (headerBegin > bytes.size() || headerBytes > bytes.size() - headerBegin)
        return invalidFile(path, "expected a header of " + std::to_string(headerBytes) +
                                     " bytes, found a file of " + std::to_string(bytes.size()));

    HeaderParser header({reinterpret_cast<const char*>(bytes.data()) + headerBegin, headerBytes});
    if (!header.parse() || !header.fortranOrder || !header.shape || header.descr.empty())
        return invalidFile(
            path, "expected a dictionary of 'descr', 'fortran_order' and 'shape' at byte " +
                      std::to_string(headerBegin) + ", found something else");
    const auto unsupported = [&](const std::string& detail) {
        return Error{ErrorCode::Unsupported, "read grid '" + path.string() + "': " + detail};
    };
    if (header.descr != "|u1" && header.descr != "|b1" && header.descr != "|i1")
        return unsupported("expected elements of type uint8, int8 or bool, found '" + header.descr +
                           "'; convert with astype('uint8')");
    if (*header.fortranOrder)
        return unsupported(
            "expected C order, found Fortran order; convert with ascontiguousarray()");
    const auto& shape = *header.shape;
    if (shape.size() != 3)
        return unsupported("expected three dimensions (NZ, NY, NX), found " + text(shape));

    const std::span<const std::byte> data = bytes.subspan(headerBegin + headerBytes);
    std::uint64_t elements = 1;
    for (const std::uint64_t count : shape) {
        if (count == 0)
            return invalidFile(path, "expected at least one voxel along each axis, found shape " +
                                         text(shape));
        // More elements than bytes is an error anyway; stopping here keeps the product in range.
        elements = count > data.size() ? data.size() + 1 : elements * count;
        if (elements > data.size())
            break;
    }
    if (elements != data.size())
        return invalidFile(path, "expected the elements of shape " + text(shape) + ", found " +
                                     std::to_string(data.size()) + " bytes of data");

    const glm::uvec3 size(static_cast<std::uint32_t>(shape[2]),
                          static_cast<std::uint32_t>(shape[1]),
                          static_cast<std::uint32_t>(shape[0]));
    const auto transform = GridTransform::box({glm::dvec3(0), glm::dvec3(size)}, size, Axis::Z);
    if (!transform)
        return transform.error();
    auto grid = BitGrid::create(*transform);
    if (!grid)
        return grid;
    const std::span<std::uint32_t> words = grid->words();
    std::size_t index = 0;
    for (std::uint32_t k = 0; k < size.z; ++k)
        for (std::uint32_t j = 0; j < size.y; ++j) {
            const std::size_t row = grid->wordIndex({0, j, k});
            for (std::uint32_t i = 0; i < size.x; ++i)
                if (data[index++] != std::byte{0})
                    words[row + std::size_t{4} * i] |= 1u << (k & 31u);
        }
    return grid;
}

} // namespace lamina::detail
