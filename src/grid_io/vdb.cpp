#include "grid_io/formats.hpp"

#if defined(LAMINA_HAS_OPENVDB)

// OpenVDB's templates keep a type's name in a static member that our instantiation and the
// library's must share; under hidden visibility they half share it and openvdb::initialize()
// crashes.
#pragma GCC visibility push(default)
#include <openvdb/openvdb.h>
#pragma GCC visibility pop

#include <algorithm>
#include <optional>
#include <ostream>
#include <streambuf>

namespace lamina::detail {
namespace {

/// A stream into an AtomicFile. OpenVDB goes back to fill in offsets, so positions must work.
class AtomicFileBuffer : public std::streambuf {
public:
    /// Reports as if about `expectedBytes` will be written.
    AtomicFileBuffer(AtomicFile& file, const GridWriteOptions& options, double expectedBytes)
        : mFile(file)
        , mOptions(options)
        , mExpectedBytes(std::max(expectedBytes, 1.0)) {}

    const Result<void>& result() const { return mResult; }

protected:
    std::streamsize xsputn(const char* text, std::streamsize count) override {
        const auto bytes = std::as_bytes(std::span(text, static_cast<std::size_t>(count)));
        const std::uint64_t inside =
            std::min<std::uint64_t>(bytes.size(), mFile.size() - mPosition);
        if (inside > 0)
            keep(mFile.overwrite(mPosition, bytes.first(inside)));
        if (inside < bytes.size())
            keep(mFile.write(bytes.subspan(inside)));
        mPosition += bytes.size();
        if (mResult && static_cast<double>(mFile.size()) >= mNextReport) {
            constexpr double kReports = 100.0;
            mNextReport += mExpectedBytes / kReports;
            if (mNextReport < mExpectedBytes)
                keep(report(mOptions,
                            std::min(1.0, static_cast<double>(mFile.size()) / mExpectedBytes)));
        }
        return mResult ? count : 0;
    }
    int_type overflow(int_type c) override {
        const char text = traits_type::to_char_type(c);
        return xsputn(&text, 1) == 1 ? c : traits_type::eof();
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode) override {
        const auto base = from == std::ios_base::beg   ? off_type{0}
                          : from == std::ios_base::cur ? static_cast<off_type>(mPosition)
                                                       : static_cast<off_type>(mFile.size());
        return seekpos(base + offset, std::ios_base::out);
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        if (position < 0 || static_cast<std::uint64_t>(position) > mFile.size())
            return pos_type(off_type(-1));
        mPosition = static_cast<std::uint64_t>(position);
        return position;
    }

private:
    void keep(Result<void> result) {
        if (mResult)
            mResult = std::move(result);
    }

    AtomicFile& mFile;
    const GridWriteOptions& mOptions;
    const double mExpectedBytes;
    double mNextReport = 0.0;
    std::uint64_t mPosition = 0;
    Result<void> mResult;
};

/// openvdb::io::File opens the file itself and overlooks a full disk; this archive writes the same
/// bytes into a stream of ours.
class StreamArchive : public openvdb::io::Archive {
public:
    void writeTo(std::ostream& stream, const openvdb::GridCPtrVec& grids) const {
        openvdb::io::Archive::write(stream, grids, /*seekable=*/true, openvdb::MetaMap());
    }
};

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
/// Not known to the tree, which nobody else changes while it is in use.
using Accessor = openvdb::tree::ValueAccessor<Tree, false>;

/// Adds the 8 x 8 x 8 voxels whose rows stand in `block` from (middle, slow), byte `byte` of a row.
void addLeaf(Accessor& accessor, const BitBlock& block, const openvdb::Coord& low,
             std::uint32_t byte, std::uint32_t middle, std::uint32_t slow) {
    const std::uint32_t rows = std::min(8u, block.extent.y - middle);
    const std::uint32_t layers = std::min(8u, block.extent.z - slow);
    Leaf::NodeMaskType mask;
    int count = 0;
    for (std::uint32_t z = 0; z < layers; ++z)
        for (std::uint32_t y = 0; y < rows; ++y) {
            const std::uint32_t bits =
                block.row(middle + y, slow + z)[byte / 4] >> (8 * (byte % 4)) & 0xffu;
            for (std::uint32_t x = 0; x < 8; ++x)
                if (bits >> x & 1u) {
                    mask.setOn((x << 6) | (y << 3) | z);
                    ++count;
                }
        }
    if (count == 0)
        return;
    if (count == 512) { // A tile: solid insides would need a gigabyte of leaves.
        accessor.addTile(1, low, 1.0f, true);
        return;
    }
    Leaf* leaf = accessor.touchLeaf(low);
    for (auto voxel = mask.beginOn(); voxel; ++voxel)
        leaf->setValueOn(voxel.pos(), 1.0f);
}

openvdb::math::Transform::Ptr transformOf(const BoxVoxels& voxels) {
    const glm::dvec3 edge = voxels.voxelSize();
    const glm::dvec3 center = voxels.bounds().min + 0.5 * edge;
    openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
    matrix.preScale(openvdb::Vec3d(edge.x, edge.y, edge.z));
    matrix.postTranslate(openvdb::Vec3d(center.x, center.y, center.z));
    return openvdb::math::Transform::createLinearTransform(matrix);
}

Result<openvdb::GridBase::Ptr> densityGrid(const BoxVoxels& voxels,
                                           const GridWriteOptions& options) {
    auto grid = openvdb::FloatGrid::create(0.0f);
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setTransform(transformOf(voxels));

    Accessor accessor(grid->tree());
    const glm::uvec3 size = voxels.size();
    BitBlock block;
    for (std::uint32_t base = 0; base < size.z; base += kSlabSlices) {
        voxels.load({0, 1, 2}, {0, 0, base}, {size.x, size.y, std::min(kSlabSlices, size.z - base)},
                    block);
        for (std::uint32_t z = 0; z < block.extent.z; z += 8)
            for (std::uint32_t y = 0; y < size.y; y += 8)
                for (std::uint32_t x = 0; x < size.x; x += 8)
                    addLeaf(accessor, block, openvdb::Coord(int(x), int(y), int(base + z)), x / 8,
                            y, z);
        if (auto goesOn = report(options, static_cast<double>(base + block.extent.z) / size.z);
            !goesOn)
            return goesOn.error();
    }
    return openvdb::GridBase::Ptr(grid);
}

/// A vector for each set voxel of which valueOf(voxel) gives one.
template<class ValueOf>
Result<openvdb::GridBase::Ptr> vectorGrid(const BoxVoxels& voxels, const char* name,
                                          const GridWriteOptions& options, ValueOf&& valueOf) {
    auto grid = openvdb::Vec3SGrid::create();
    grid->setName(name);
    grid->setTransform(transformOf(voxels));
    openvdb::tree::ValueAccessor<openvdb::Vec3STree, false> accessor(grid->tree());
    auto visited =
        forEachRow(voxels, {0, 1, 2}, options,
                   [&](std::span<const std::uint32_t> row, std::uint32_t y, std::uint32_t z) {
                       forEachBit(row, [&](std::uint32_t x) {
                           if (const auto value = valueOf(glm::uvec3(x, y, z)))
                               accessor.setValue(openvdb::Coord(int(x), int(y), int(z)),
                                                 openvdb::Vec3s(value->x, value->y, value->z));
                       });
                       return Result<void>();
                   });
    if (!visited)
        return visited.error();
    return openvdb::GridBase::Ptr(grid);
}

Result<openvdb::GridBase::Ptr> colorGrid(const BoxVoxels& voxels, const GridWriteOptions& options) {
    return vectorGrid(voxels, "color", options,
                      [&](const glm::uvec3& voxel) -> std::optional<glm::vec3> {
                          const glm::u8vec4 color = voxels.color(voxel);
                          if (color == glm::u8vec4(0))
                              return std::nullopt;
                          return glm::vec3(color) / 255.0f;
                      });
}

Result<openvdb::GridBase::Ptr> normalGrid(const BoxVoxels& voxels,
                                          const GridWriteOptions& options) {
    auto grid = vectorGrid(voxels, "normal", options,
                           [&](const glm::uvec3& voxel) -> std::optional<glm::vec3> {
                               const glm::vec3 normal = voxels.normal(voxel);
                               if (normal == glm::vec3(0.0f))
                                   return std::nullopt;
                               return normal;
                           });
    if (grid)
        (*grid)->setVectorType(openvdb::VEC_COVARIANT_NORMALIZE);
    return grid;
}

/// Density, then the attributes there are.
Result<openvdb::GridCPtrVec> makeGrids(const BoxVoxels& voxels, const GridWriteOptions& options) {
    std::vector<decltype(&densityGrid)> makers{densityGrid};
    if (voxels.hasColors())
        makers.push_back(colorGrid);
    if (voxels.hasNormals())
        makers.push_back(normalGrid);
    const auto count = static_cast<double>(makers.size());
    openvdb::GridCPtrVec grids;
    for (const auto& make : makers) {
        const auto place = static_cast<double>(grids.size());
        auto grid = make(voxels, partOf(options, place / count, (place + 1.0) / count));
        if (!grid)
            return grid.error();
        grids.push_back(std::move(*grid));
    }
    return grids;
}

double memoryBytes(const openvdb::GridCPtrVec& grids) {
    double bytes = 0.0;
    for (const auto& grid : grids)
        bytes += static_cast<double>(grid->memUsage());
    return bytes;
}

} // namespace

Result<void> writeVdb(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options) {
    openvdb::initialize();
    // Writing the trees takes about as long as building them.
    const auto grids = makeGrids(voxels, partOf(options, 0.0, 0.5));
    if (!grids)
        return grids.error();
    const GridWriteOptions writing = partOf(options, 0.5, 1.0);
    AtomicFileBuffer buffer(file, writing, memoryBytes(*grids));
    try {
        std::ostream stream(&buffer);
        stream.exceptions(std::ios::badbit | std::ios::failbit);
        StreamArchive().writeTo(stream, *grids);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        if (buffer.result())
            return Error{ErrorCode::InputOutput,
                         std::string("write vdb: expected OpenVDB to write the grid, found: ") +
                             error.what()};
    }
    if (!buffer.result())
        return buffer.result();
    return report(options, 1.0);
}

} // namespace lamina::detail

#else

namespace lamina::detail {

Result<void> writeVdb(AtomicFile&, const BoxVoxels&, const GridWriteOptions&) {
    return Error{ErrorCode::Unsupported,
                 "write vdb: expected a lamina built with OpenVDB, found one without"};
}

} // namespace lamina::detail

#endif
