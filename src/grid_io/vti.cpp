#include "grid_io/formats.hpp"

#include <algorithm>
#include <bit>
#include <zlib.h>

namespace lamina::detail {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

std::string triple(const glm::dvec3& v) {
    return exactText(v.x) + " " + exactText(v.y) + " " + exactText(v.z);
}

std::string preamble(const BoxVoxels& voxels) {
    const glm::uvec3 size = voxels.size();
    const std::string extent = "0 " + std::to_string(size.x) + " 0 " + std::to_string(size.y) +
                               " 0 " + std::to_string(size.z);
    return "<?xml version=\"1.0\"?>\n"
           "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
           "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
           "<ImageData WholeExtent=\"" +
           extent + "\" Origin=\"" + triple(voxels.bounds().min) + "\" Spacing=\"" +
           triple(voxels.voxelSize()) + "\">\n<Piece Extent=\"" + extent +
           "\">\n<CellData Scalars=\"occupancy\">\n"
           "<DataArray type=\"UInt8\" Name=\"occupancy\" RangeMin=\"0\" RangeMax=\"1\" "
           "format=\"appended\" offset=\"0\"/>\n"
           "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
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
        uLongf bytes = mCompressed.size();
        // The fastest level: bits as bytes compress a hundredfold at any.
        if (compress2(mCompressed.data(), &bytes, mBlock.data(), mBlock.size(), Z_BEST_SPEED) !=
            Z_OK)
            return Error{ErrorCode::OutOfMemory, "write vti: expected zlib to compress " +
                                                     std::to_string(mBlock.size()) +
                                                     " bytes, found too little memory"};
        mHeader[3 + mStoredBlocks++] = bytes;
        mBlock.clear();
        return mFile.write(std::as_bytes(std::span(mCompressed).first(bytes)));
    }

    AtomicFile& mFile;
    std::vector<std::uint64_t> mHeader;
    std::vector<Bytef> mBlock, mCompressed;
    std::uint64_t mHeaderOffset = 0;
    std::size_t mStoredBlocks = 0;
};

} // namespace

Result<void> writeVti(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options) {
    static_assert(std::endian::native == std::endian::little,
                  "the header numbers are stored as they are");
    const glm::uvec3 size = voxels.size();
    if (auto written = file.write(preamble(voxels)); !written)
        return written;
    CompressedArray array(file, std::uint64_t{size.x} * size.y * size.z);
    if (auto begun = array.begin(); !begun)
        return begun;
    std::vector<std::uint8_t> bytes(size.x);
    auto rows = forEachRow(voxels, {0, 1, 2}, options,
                           [&](std::span<const std::uint32_t> row, std::uint32_t, std::uint32_t) {
                               expandBits(row, size.x, bytes.data());
                               return array.add(bytes);
                           });
    if (!rows)
        return rows;
    if (auto finished = array.finish(); !finished)
        return finished;
    return file.write("\n</AppendedData>\n</VTKFile>\n");
}

} // namespace lamina::detail
