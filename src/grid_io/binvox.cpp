#include "grid_io/formats.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>

namespace lamina::detail {
namespace {

/// The file's order: y runs fastest, then z, then x.
constexpr AxisOrder kOrder{1, 2, 0};
constexpr std::uint32_t kLongestRun = 255;

/// Cuts a stream of equal bits into the file's pairs of value and length.
class RunWriter {
public:
    explicit RunWriter(AtomicFile& file)
        : mFile(file) {}

    Result<void> add(bool value, std::uint64_t length) {
        if (value != mValue) {
            if (auto flushed = finish(); !flushed)
                return flushed;
            mValue = value;
        }
        mLength += length;
        return {};
    }

    Result<void> finish() {
        for (; mLength > 0; mLength -= std::min<std::uint64_t>(mLength, kLongestRun)) {
            const std::byte pair[2] = {
                std::byte{mValue},
                static_cast<std::byte>(std::min<std::uint64_t>(mLength, kLongestRun))};
            if (auto written = mFile.write(pair); !written)
                return written;
        }
        return {};
    }

private:
    AtomicFile& mFile;
    bool mValue = false;
    std::uint64_t mLength = 0;
};

Result<void> addRow(RunWriter& runs, std::span<const std::uint32_t> row, std::uint32_t count) {
    for (std::uint32_t begin = 0; begin < count;) {
        const std::uint32_t word = row[begin / 32] >> (begin % 32);
        const bool value = word & 1u;
        const int same = value ? std::countr_one(word) : std::countr_zero(word);
        const std::uint32_t length =
            std::min({static_cast<std::uint32_t>(same), 32 - begin % 32, count - begin});
        if (auto added = runs.add(value, length); !added)
            return added;
        begin += length;
    }
    return {};
}

struct Header {
    glm::uvec3 size{0}; ///< Along world x, y, z.
    glm::dvec3 translate{0.0};
    double scale = 1.0;
    std::size_t dataBegin = 0;
};

/// One line of a header: its words, and its number for messages.
class LineReader {
public:
    explicit LineReader(std::span<const std::byte> bytes)
        : mText(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

    std::size_t number = 0;
    std::string_view line;

    bool next() {
        // No line of a header is longer; a binary file must not be searched to its end.
        const std::size_t end = mText.substr(mPosition, 256).find('\n');
        if (end == std::string_view::npos)
            return false;
        line = mText.substr(mPosition, end);
        if (line.ends_with('\r'))
            line.remove_suffix(1);
        mPosition += end + 1;
        ++number;
        return true;
    }

    std::size_t position() const { return mPosition; }

    std::string_view word() {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        const std::string_view result = line.substr(0, line.find_first_of(" \t"));
        line.remove_prefix(result.size());
        return result;
    }

    template<class Number>
    bool number3(Number (&out)[3], int count) {
        for (int i = 0; i < count; ++i) {
            const std::string_view text = word();
            const auto [end, error] =
                std::from_chars(text.data(), text.data() + text.size(), out[i]);
            if (error != std::errc() || end != text.data() + text.size())
                return false;
        }
        return word().empty();
    }

private:
    std::string_view mText;
    std::size_t mPosition = 0;
};

Result<Header> readHeader(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    LineReader lines(bytes);
    const auto failure = [&](const std::string& expected) {
        return invalidFile(path, "line " + std::to_string(std::max<std::size_t>(lines.number, 1)) +
                                     ": expected " + expected + ", found something else");
    };
    if (!lines.next() || lines.word() != "#binvox" || lines.word() != "1")
        return failure("'#binvox 1'");
    Header header;
    while (lines.next()) {
        const std::string_view key = lines.word();
        std::uint32_t dims[3] = {};
        double numbers[3] = {};
        if (key == "dim") {
            if (!lines.number3(dims, 3) || dims[0] == 0 || dims[1] == 0 || dims[2] == 0)
                return failure("'dim' and three counts from 1 to 4294967295");
            header.size = {dims[0], dims[2], dims[1]};
        } else if (key == "translate") {
            if (!lines.number3(numbers, 3) || !std::isfinite(numbers[0]) ||
                !std::isfinite(numbers[1]) || !std::isfinite(numbers[2]))
                return failure("'translate' and three finite numbers");
            header.translate = {numbers[0], numbers[1], numbers[2]};
        } else if (key == "scale") {
            if (!lines.number3(numbers, 1) || !std::isfinite(numbers[0]) || !(numbers[0] > 0.0))
                return failure("'scale' and a positive number");
            header.scale = numbers[0];
        } else if (key == "data") {
            if (header.size.x == 0)
                return failure("'dim' before 'data'");
            header.dataBegin = lines.position();
            return header;
        } else if (!key.starts_with('#')) {
            return failure("dim, translate, scale or data");
        }
    }
    return invalidFile(path, "after line " + std::to_string(lines.number) +
                                 ": expected the line 'data', found none");
}

Result<void> checkTotal(std::span<const std::byte> pairs, const Header& header,
                        const std::filesystem::path& path) {
    const std::string dims = std::to_string(header.size.x) + " x " + std::to_string(header.size.y) +
                             " x " + std::to_string(header.size.z);
    // In floating point no count of the header can overflow; below 2^53 it is exact.
    const double voxels =
        static_cast<double>(header.size.x) * header.size.y * static_cast<double>(header.size.z);
    std::uint64_t total = 0;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
        const auto value = std::to_integer<unsigned>(pairs[i]);
        const auto length = std::to_integer<unsigned>(pairs[i + 1]);
        if (value > 1 || length == 0)
            return invalidFile(path,
                               "byte " + std::to_string(header.dataBegin + i) +
                                   ": expected a value of 0 or 1 and a length of 1 to 255, found " +
                                   std::to_string(value) + " and " + std::to_string(length));
        total += length;
    }
    if (pairs.size() % 2 != 0)
        return invalidFile(path, "expected pairs of bytes, found one alone at the end");
    if (static_cast<double>(total) != voxels)
        return invalidFile(path, "expected runs for the voxels of " + dims + ", found runs for " +
                                     std::to_string(total) + " voxels");
    const glm::dvec3 size(header.size);
    const double columnBytes = 16.0 * std::max(size.x * size.z * std::ceil(size.y / 128.0),
                                               size.x * size.y * std::ceil(size.z / 128.0));
    const double limit = 512.0 * (1 << 20) + 32.0 * static_cast<double>(pairs.size());
    if (columnBytes > limit)
        return Error{ErrorCode::OutOfMemory,
                     "read grid '" + path.string() + "': expected at most " +
                         std::to_string(static_cast<std::uint64_t>(limit)) +
                         " bytes of voxels in a file of this size, found " + dims};
    return {};
}

/// Sets bits [begin, begin + length) of a column; `words` as in BitGrid.
void setRun(BitGrid& grid, const glm::uvec2& column, std::uint32_t begin, std::uint32_t length) {
    const std::span<std::uint32_t> words = grid.words();
    while (length > 0) {
        const std::uint32_t offset = begin % 32;
        const std::uint32_t count = std::min(length, 32 - offset);
        const std::uint32_t mask = count == 32 ? ~0u : ((1u << count) - 1u) << offset;
        words[grid.wordIndex({column, begin})] |= mask;
        begin += count;
        length -= count;
    }
}

} // namespace

Result<void> writeBinvox(AtomicFile& file, const BoxVoxels& voxels,
                         const GridWriteOptions& options) {
    const glm::uvec3 size = voxels.size();
    const glm::dvec3 edge = voxels.voxelSize();
    const double longestEdge = std::max({edge.x, edge.y, edge.z});
    const double shortestEdge = std::min({edge.x, edge.y, edge.z});
    // The tolerance is for boxes made as low corner + count * edge and rounded.
    if (longestEdge - shortestEdge > 1e-6 * longestEdge)
        return Error{ErrorCode::Unsupported, "write binvox: expected cubic voxels, found edges " +
                                                 exactText(edge.x) + ", " + exactText(edge.y) +
                                                 ", " + exactText(edge.z) +
                                                 "; choose .vti or .vdb"};
    const Box3& bounds = voxels.bounds();
    const glm::dvec3 sides = bounds.size();
    const std::string header =
        "#binvox 1\ndim " + std::to_string(size.x) + " " + std::to_string(size.z) + " " +
        std::to_string(size.y) + "\ntranslate " + exactText(bounds.min.x) + " " +
        exactText(bounds.min.y) + " " + exactText(bounds.min.z) + "\nscale " +
        exactText(std::max({sides.x, sides.y, sides.z})) + "\ndata\n";
    if (auto written = file.write(header); !written)
        return written;
    RunWriter runs(file);
    auto written = forEachRow(voxels, kOrder, options,
                              [&](std::span<const std::uint32_t> row, std::uint32_t,
                                  std::uint32_t) { return addRow(runs, row, size.y); });
    return written ? runs.finish() : written;
}

Result<BitGrid> readBinvox(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    const auto header = readHeader(bytes, path);
    if (!header)
        return header.error();
    const std::span<const std::byte> pairs = bytes.subspan(header->dataBegin);
    if (auto checked = checkTotal(pairs, *header, path); !checked)
        return checked.error();

    const glm::uvec3 size = header->size;
    const double edge = header->scale / std::max({size.x, size.y, size.z});
    const Box3 box{header->translate, header->translate + edge * glm::dvec3(size)};
    // Columns along y take a run of the file in a few words.
    const auto transform = GridTransform::box(box, size, Axis::Y);
    if (!transform)
        return invalidFile(path, transform.error().text);
    auto grid = BitGrid::create(*transform);
    if (!grid)
        return grid;
    std::uint32_t x = 0, y = 0, z = 0;
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
        const bool value = pairs[i] == std::byte{1};
        for (auto left = std::to_integer<std::uint32_t>(pairs[i + 1]); left > 0;) {
            const std::uint32_t length = std::min(left, size.y - y);
            if (value)
                setRun(*grid, {z, x}, y, length);
            left -= length;
            y += length;
            if (y == size.y) {
                y = 0;
                z = z + 1 == size.z ? 0 : z + 1;
                x += z == 0;
            }
        }
    }
    return grid->reoriented(Axis::Z);
}

} // namespace lamina::detail
