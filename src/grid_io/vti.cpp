#include "grid_io/formats.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>
#include <zlib.h>

namespace lamina::detail {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

std::string triple(const glm::dvec3& v) {
    return exactText(v.x) + " " + exactText(v.y) + " " + exactText(v.z);
}

/// An array of the cells. Its place in the file is known once those before it are written.
struct CellArray {
    std::string_view type, name;
    std::uint32_t components;
    std::uint32_t componentBytes;
};

constexpr CellArray kOccupancy{"UInt8", "occupancy", 1, 1};
constexpr CellArray kColor{"UInt8", "color", 4, 1};
constexpr CellArray kNormal{"Float32", "normal", 3, 4};
/// Digits of an offset that is filled in later.
constexpr std::size_t kOffsetDigits = 20;

std::string offsetText(std::uint64_t offset) {
    const std::string digits = std::to_string(offset);
    return std::string(kOffsetDigits - digits.size(), '0') + digits;
}

/// offsets: where the text of each array's offset stands.
std::string preamble(const BoxVoxels& voxels, std::span<const CellArray> arrays,
                     std::vector<std::uint64_t>& offsets) {
    const glm::uvec3 size = voxels.size();
    const std::string extent = "0 " + std::to_string(size.x) + " 0 " + std::to_string(size.y) +
                               " 0 " + std::to_string(size.z);
    std::string text = "<?xml version=\"1.0\"?>\n"
                       "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                       "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
                       "<ImageData WholeExtent=\"" +
                       extent + "\" Origin=\"" + triple(voxels.bounds().min) + "\" Spacing=\"" +
                       triple(voxels.voxelSize()) + "\">\n<Piece Extent=\"" + extent +
                       "\">\n<CellData Scalars=\"occupancy\"" +
                       (voxels.hasNormals() ? " Normals=\"normal\"" : "") + ">\n";
    for (const CellArray& array : arrays) {
        text += "<DataArray type=\"" + std::string(array.type) + "\" Name=\"" +
                std::string(array.name) + "\"";
        if (array.components > 1)
            text += " NumberOfComponents=\"" + std::to_string(array.components) + "\"";
        else
            text += " RangeMin=\"0\" RangeMax=\"1\"";
        text += " format=\"appended\" offset=\"";
        offsets.push_back(text.size());
        text += offsetText(0) + "\"/>\n";
    }
    return text + "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
}

/// VTK's compressed array: the number of blocks, the bytes of a whole block, the bytes of the last
/// one (0 if whole), the compressed bytes of each, as 64-bit numbers; then the blocks.
class CompressedArray {
public:
    CompressedArray(AtomicFile& file, std::uint64_t bytes)
        : mFile(file)
        , mHeader(3 + (bytes + kBlockBytes - 1) / kBlockBytes)
        , mCompressed(compressBound(kBlockBytes)) {
        mHeader[0] = mHeader.size() - 3;
        mHeader[1] = kBlockBytes;
        mHeader[2] = bytes % kBlockBytes;
        mBlock.reserve(kBlockBytes);
    }

    Result<void> begin() {
        mHeaderOffset = mFile.size();
        return mFile.write(std::as_bytes(std::span(mHeader)));
    }

    Result<void> add(std::span<const std::uint8_t> bytes) {
        while (!bytes.empty()) {
            const std::size_t taken = std::min(bytes.size(), kBlockBytes - mBlock.size());
            mBlock.insert(mBlock.end(), bytes.begin(),
                          bytes.begin() + static_cast<std::ptrdiff_t>(taken));
            bytes = bytes.subspan(taken);
            if (mBlock.size() == kBlockBytes)
                if (auto stored = storeBlock(); !stored)
                    return stored;
        }
        return {};
    }

    Result<void> finish() {
        if (!mBlock.empty())
            if (auto stored = storeBlock(); !stored)
                return stored;
        return mFile.overwrite(mHeaderOffset, std::as_bytes(std::span(mHeader)));
    }

private:
    Result<void> storeBlock() {
        // Most blocks of sparse arrays are zeros: compressed once.
        const bool isZero = std::ranges::all_of(mBlock, [](Bytef byte) { return byte == 0; });
        if (isZero && mBlock.size() == kBlockBytes && !mZeroBlock.empty())
            return append(mZeroBlock);
        uLongf bytes = mCompressed.size();
        // The fastest level: bits as bytes compress a hundredfold at any.
        if (compress2(mCompressed.data(), &bytes, mBlock.data(), mBlock.size(), Z_BEST_SPEED) !=
            Z_OK)
            return Error{ErrorCode::OutOfMemory, "write vti: expected zlib to compress " +
                                                     std::to_string(mBlock.size()) +
                                                     " bytes, found too little memory"};
        const std::span<const Bytef> block = std::span(mCompressed).first(bytes);
        if (isZero && mBlock.size() == kBlockBytes)
            mZeroBlock.assign(block.begin(), block.end());
        return append(block);
    }

    Result<void> append(std::span<const Bytef> compressed) {
        mHeader[3 + mStoredBlocks++] = compressed.size();
        mBlock.clear();
        return mFile.write(std::as_bytes(compressed));
    }

    AtomicFile& mFile;
    std::vector<std::uint64_t> mHeader;
    std::vector<Bytef> mBlock, mCompressed, mZeroBlock;
    std::uint64_t mHeaderOffset = 0;
    std::size_t mStoredBlocks = 0;
};

/// Fills the bytes of a row of cells.
void fillRow(const BoxVoxels& voxels, const CellArray& array, std::span<const std::uint32_t> row,
             std::uint32_t y, std::uint32_t z, std::vector<std::uint8_t>& bytes) {
    if (array.name == kOccupancy.name)
        return expandBits(row, voxels.size().x, bytes.data());
    std::ranges::fill(bytes, std::uint8_t{0});
    forEachBit(row, [&](std::uint32_t x) {
        const glm::uvec3 voxel(x, y, z);
        std::uint8_t* target =
            bytes.data() + std::size_t{x} * array.components * array.componentBytes;
        if (array.name == kColor.name) {
            const glm::u8vec4 color = voxels.color(voxel);
            std::memcpy(target, &color, sizeof color);
        } else {
            const glm::vec3 normal = voxels.normal(voxel);
            std::memcpy(target, &normal, sizeof normal);
        }
    });
}

Result<void> writeArray(AtomicFile& file, const BoxVoxels& voxels, const CellArray& array,
                        const GridWriteOptions& options) {
    const glm::uvec3 size = voxels.size();
    std::vector<std::uint8_t> bytes(std::size_t{size.x} * array.components * array.componentBytes);
    CompressedArray compressed(file, std::uint64_t{bytes.size()} * size.y * size.z);
    if (auto begun = compressed.begin(); !begun)
        return begun;
    auto rows =
        forEachRow(voxels, {0, 1, 2}, options,
                   [&](std::span<const std::uint32_t> row, std::uint32_t y, std::uint32_t z) {
                       fillRow(voxels, array, row, y, z, bytes);
                       return compressed.add(bytes);
                   });
    if (!rows)
        return rows;
    return compressed.finish();
}

} // namespace

Result<void> writeVti(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options) {
    static_assert(std::endian::native == std::endian::little,
                  "the header numbers are stored as they are");
    std::vector<CellArray> arrays{kOccupancy};
    if (voxels.hasColors())
        arrays.push_back(kColor);
    if (voxels.hasNormals())
        arrays.push_back(kNormal);
    std::vector<std::uint64_t> offsets;
    if (auto written = file.write(preamble(voxels, arrays, offsets)); !written)
        return written;
    const std::uint64_t begin = file.size();
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        const std::string offset = offsetText(file.size() - begin);
        if (auto stored = file.overwrite(offsets[i], std::as_bytes(std::span(offset))); !stored)
            return stored;
        const auto count = static_cast<double>(arrays.size());
        const GridWriteOptions part =
            partOf(options, static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
        if (auto written = writeArray(file, voxels, arrays[i], part); !written)
            return written;
    }
    return file.write("\n</AppendedData>\n</VTKFile>\n");
}

} // namespace lamina::detail
