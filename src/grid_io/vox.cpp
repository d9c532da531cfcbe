#include "grid_io/formats.hpp"
#include "grid_io/palette.hpp"

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <limits>
#include <utility>

namespace lamina::detail {
namespace {

constexpr std::uint32_t kModelSide = 256;
/// Of voxels without a colour.
constexpr std::uint32_t kPlainColor = 0x528de8;

/// How the file's axes lie in the world, see GridWriteOptions::up.
struct Mapping {
    AxisOrder order;      ///< World axes that become the file's x, y, z.
    bool mirrorY = false; ///< The file's y runs against its world axis.
};

Mapping mapping(Axis up) {
    switch (up) {
    case Axis::X:
        return {{1, 2, 0}};
    case Axis::Y:
        return {{0, 2, 1}, true};
    case Axis::Z:
        break;
    }
    return {{0, 1, 2}};
}

/// The bytes of a chunk or dictionary, little-endian.
class Bytes {
public:
    Bytes& number(std::int64_t value) {
        const auto bits = static_cast<std::uint32_t>(value);
        for (int shift = 0; shift < 32; shift += 8)
            mText += static_cast<char>(bits >> shift & 0xffu);
        return *this;
    }
    Bytes& numbers(std::initializer_list<std::int64_t> values) {
        for (const std::int64_t value : values)
            number(value);
        return *this;
    }
    Bytes& string(const std::string& text) {
        number(static_cast<std::int64_t>(text.size()));
        mText += text;
        return *this;
    }
    Bytes& dictionary(std::initializer_list<std::pair<std::string, std::string>> entries) {
        number(static_cast<std::int64_t>(entries.size()));
        for (const auto& [key, value] : entries)
            string(key).string(value);
        return *this;
    }
    Bytes& raw(const std::string& text) {
        mText += text;
        return *this;
    }
    const std::string& text() const { return mText; }

private:
    std::string mText;
};

Result<void> writeChunk(AtomicFile& file, const std::string& id, const Bytes& content) {
    Bytes header;
    header.raw(id).numbers({static_cast<std::int64_t>(content.text().size()), 0});
    return file.write(header.text() + content.text());
}

/// A part of the grid in file axes.
struct Model {
    glm::uvec3 low;
    glm::uvec3 size;
};

/// The low corner of `model` along the world axes of the file's x, y, z.
glm::uvec3 worldLow(const Mapping& map, const Model& model, std::uint32_t sizeY) {
    glm::uvec3 low = model.low;
    if (map.mirrorY)
        low.y = sizeY - model.low.y - model.size.y;
    return low;
}

/// Red lowest, without alpha.
std::uint32_t colorOf(const BoxVoxels& voxels, const glm::uvec3& voxel) {
    const glm::u8vec4 color = voxels.color(voxel);
    if (color == glm::u8vec4(0))
        return kPlainColor;
    return color.r | std::uint32_t{color.g} << 8u | std::uint32_t{color.b} << 16u;
}

Result<Palette> makePalette(const BoxVoxels& voxels, const GridWriteOptions& options) {
    if (!voxels.hasColors())
        return Palette::single(kPlainColor);
    PaletteBuilder builder;
    auto visited = forEachRow(
        voxels, {0, 1, 2}, options,
        [&](std::span<const std::uint32_t> row, std::uint32_t y, std::uint32_t z) {
            forEachBit(row, [&](std::uint32_t x) { builder.add(colorOf(voxels, {x, y, z})); });
            return Result<void>();
        });
    if (!visited)
        return visited.error();
    return builder.build(kPaletteColors);
}

/// Writes a part of the grid; paletteIndex(x, y, z): of the voxel with these indices in `block`.
template<class PaletteIndex>
Result<void> writeModel(AtomicFile& file, const BitBlock& block, std::uint32_t count, bool mirrorY,
                        PaletteIndex&& paletteIndex) {
    const glm::uvec3 size = block.extent;
    if (auto written = writeChunk(file, "SIZE", Bytes().numbers({size.x, size.y, size.z}));
        !written)
        return written;
    Bytes header;
    header.raw("XYZI").numbers({std::int64_t{4} * count + 4, 0, count});
    if (auto written = file.write(header.text()); !written)
        return written;
    std::vector<std::uint8_t> entries;
    for (std::uint32_t z = 0; z < size.z; ++z) {
        entries.clear();
        for (std::uint32_t y = 0; y < size.y; ++y) {
            const std::uint32_t worldY = mirrorY ? size.y - 1 - y : y;
            forEachBit(block.row(worldY, z), [&](std::uint32_t x) {
                entries.insert(entries.end(),
                               {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                                static_cast<std::uint8_t>(z), paletteIndex(x, worldY, z)});
            });
        }
        if (auto written = file.write(std::as_bytes(std::span(entries))); !written)
            return written;
    }
    return {};
}

/// Places the models so that the grid is centred on the origin in x and y and stands on z = 0.
/// A model's translation names its centre voxel, size / 2.
Result<void> writeSceneGraph(AtomicFile& file, const std::vector<Model>& models,
                             const glm::uvec3& size) {
    Bytes root;
    root.number(0).dictionary({}).numbers({1, -1, -1, 1}).dictionary({});
    if (auto written = writeChunk(file, "nTRN", root); !written)
        return written;
    Bytes group;
    group.number(1).dictionary({}).number(static_cast<std::int64_t>(models.size()));
    for (std::size_t i = 0; i < models.size(); ++i)
        group.number(static_cast<std::int64_t>(2 + 2 * i));
    if (auto written = writeChunk(file, "nGRP", group); !written)
        return written;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const Model& model = models[i];
        const glm::ivec3 center =
            glm::ivec3(model.low + model.size / 2u) - glm::ivec3(size.x / 2, size.y / 2, 0);
        const auto node = static_cast<std::int64_t>(2 + 2 * i);
        Bytes transform;
        transform.number(node).dictionary({}).numbers({node + 1, -1, -1, 1});
        transform.dictionary({{"_t", std::to_string(center.x) + " " + std::to_string(center.y) +
                                         " " + std::to_string(center.z)}});
        if (auto written = writeChunk(file, "nTRN", transform); !written)
            return written;
        Bytes shape;
        shape.number(node + 1)
            .dictionary({})
            .numbers({1, static_cast<std::int64_t>(i)})
            .dictionary({});
        if (auto written = writeChunk(file, "nSHP", shape); !written)
            return written;
    }
    return {};
}

/// The colours of the voxels from index 1 on; the rest is a ramp of greys, ready for painting.
Bytes paletteChunk(const Palette& palette) {
    std::string bytes;
    for (std::size_t i = 0; i < 256; ++i)
        for (unsigned channel = 0; channel < 4; ++channel)
            bytes +=
                static_cast<char>(channel == 3                  ? 255
                                  : i < palette.colors().size() ? palette.colors()[i] >> 8 * channel
                                                                : 255 - i);
    return Bytes().raw(bytes);
}

/// Models that the grid's box takes, empty ones too.
std::uint64_t modelCount(const glm::uvec3& size) {
    const glm::u64vec3 models =
        (glm::u64vec3(size) + std::uint64_t{kModelSide - 1}) / std::uint64_t{kModelSide};
    return models.x * models.y * models.z;
}

Result<void> checkLimits(const BoxVoxels& voxels, const glm::uvec3& size) {
    // The size of all chunks together is one signed 32-bit number.
    constexpr std::uint64_t kMostVoxels = std::numeric_limits<std::int32_t>::max() / 4 - (1u << 20);
    if (const std::uint64_t count = voxels.count(); count > kMostVoxels)
        return Error{ErrorCode::Unsupported,
                     "write vox: expected at most " + std::to_string(kMostVoxels) +
                         " set voxels, found " + std::to_string(count) + "; choose .vdb or .vti"};
    const std::uint64_t models = modelCount(size);
    constexpr std::uint64_t kMostModels = 4096;
    if (models > kMostModels)
        return Error{ErrorCode::Unsupported, "write vox: expected at most " +
                                                 std::to_string(kMostModels) +
                                                 " models of 256 voxels a side, found " +
                                                 std::to_string(models) + "; choose .vdb or .vti"};
    return {};
}

/// Does one model hold the grid?
bool isSingle(const glm::uvec3& size) {
    return std::max({size.x, size.y, size.z}) <= kModelSide;
}

/// Writes what lies in a model's box and tells whether it is one of the file's models: an empty one
/// is not, unless it is the only one.
Result<bool> writeModel(AtomicFile& file, const BoxVoxels& voxels, const Mapping& map,
                        const glm::uvec3& size, const Palette& palette, const Model& model,
                        BitBlock& block) {
    const glm::uvec3 corner = worldLow(map, model, size.y);
    voxels.load(map.order, corner, model.size, block);
    std::uint32_t count = 0;
    for (const std::uint32_t word : block.words)
        count += static_cast<std::uint32_t>(std::popcount(word));
    if (count == 0 && !isSingle(size))
        return false;
    const auto paletteIndex = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        if (!voxels.hasColors())
            return std::uint8_t{1};
        glm::uvec3 voxel;
        voxel[map.order.fast] = corner.x + i;
        voxel[map.order.middle] = corner.y + j;
        voxel[map.order.slow] = corner.z + k;
        return static_cast<std::uint8_t>(1 + palette.index(colorOf(voxels, voxel)));
    };
    if (auto written = writeModel(file, block, count, map.mirrorY, paletteIndex); !written)
        return written.error();
    return true;
}

/// Writes all models and gives those that the file has: at least one, for a file needs one.
Result<std::vector<Model>> writeModels(AtomicFile& file, const BoxVoxels& voxels,
                                       const Mapping& map, const glm::uvec3& size,
                                       const Palette& palette, const GridWriteOptions& options) {
    std::vector<Model> models;
    BitBlock block;
    const std::uint64_t total = modelCount(size);
    std::uint64_t done = 0;
    for (std::uint32_t z = 0; z < size.z; z += kModelSide)
        for (std::uint32_t y = 0; y < size.y; y += kModelSide)
            for (std::uint32_t x = 0; x < size.x; x += kModelSide) {
                const glm::uvec3 low(x, y, z);
                const Model model{low, glm::min(size - low, glm::uvec3(kModelSide))};
                const auto written = writeModel(file, voxels, map, size, palette, model, block);
                if (!written)
                    return written.error();
                if (*written)
                    models.push_back(model);
                // At each hundredth, however many models there are.
                ++done;
                if (done * 100 / total != (done - 1) * 100 / total)
                    if (auto goesOn =
                            report(options, static_cast<double>(done) / static_cast<double>(total));
                        !goesOn)
                        return goesOn.error();
            }
    if (models.empty()) {
        models.push_back({glm::uvec3(0), glm::uvec3(1)});
        block = {glm::uvec3(1), 1, {0}};
        const auto none = [](std::uint32_t, std::uint32_t, std::uint32_t) {
            return std::uint8_t{1};
        };
        if (auto written = writeModel(file, block, 0, false, none); !written)
            return written.error();
    }
    return models;
}

} // namespace

Result<void> writeVox(AtomicFile& file, const BoxVoxels& voxels, const GridWriteOptions& options) {
    const Mapping map = mapping(options.up);
    const glm::uvec3 size{voxels.size()[map.order.fast], voxels.size()[map.order.middle],
                          voxels.size()[map.order.slow]};
    if (auto checked = checkLimits(voxels, size); !checked)
        return checked;
    Bytes start;
    start.raw("VOX ").number(150).raw("MAIN").numbers({0, 0});
    if (auto written = file.write(start.text()); !written)
        return written;
    const std::uint64_t childrenBegin = file.size();

    const double paletteShare = voxels.hasColors() ? 0.4 : 0.0;
    const auto palette = makePalette(voxels, partOf(options, 0.0, paletteShare));
    if (!palette)
        return palette.error();
    const auto models =
        writeModels(file, voxels, map, size, *palette, partOf(options, paletteShare, 1.0));
    if (!models)
        return models.error();
    if (!isSingle(size))
        if (auto written = writeSceneGraph(file, *models, size); !written)
            return written;
    if (auto written = writeChunk(file, "RGBA", paletteChunk(*palette)); !written)
        return written;
    Bytes childrenBytes;
    childrenBytes.number(static_cast<std::int64_t>(file.size() - childrenBegin));
    return file.overwrite(childrenBegin - 4, std::as_bytes(std::span(childrenBytes.text())));
}

} // namespace lamina::detail
