#include "gl/device_state.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"

#include <lamina/grid/voxel_grid.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace lamina {
namespace {

constexpr std::uint32_t kTexelBytes = 16;
constexpr std::uint32_t kRangeBytes = 8;
static_assert(sizeof(ColumnRange) == kRangeBytes);

} // namespace

std::string_view name(VoxelStore store) {
    return store == VoxelStore::Texture ? "texture" : "buffer";
}

struct VoxelGrid::Impl {
    /// The voxels' memory.
    struct Words {
        VoxelStore store = VoxelStore::Texture;
        glm::uvec3 size{0};  ///< Columns x, columns y, layers.
        gl::Texture texture; ///< The words, or a view of `buffer`.
        gl::Buffer buffer;   ///< The words, in the buffer store.
    };

    std::shared_ptr<gl::DeviceState> device;
    gl::Buffer uniforms;
    Words words;
    std::shared_ptr<gl::Texture> ranges; ///< Near/far map; null without local ranges.
    std::optional<GridTransform> transform;

    /// Memory for a grid of this shape.
    [[nodiscard]] Result<Words> allocate(VoxelStore store, const glm::uvec3& layered,
                                         const std::string& operation) const;
    /// Takes place and ranges; the words have the right shape.
    void assign(const GridTransform& place, std::shared_ptr<gl::Texture> newRanges);
    void uploadRanges(std::span<const ColumnRange> columns) const;
    [[nodiscard]] std::vector<ColumnRange> downloadRanges() const;
};

Result<VoxelGrid::Impl::Words> VoxelGrid::Impl::allocate(VoxelStore store,
                                                         const glm::uvec3& layered,
                                                         const std::string& operation) const {
    Words fresh;
    fresh.store = store;
    fresh.size = layered;
    if (store == VoxelStore::Texture) {
        auto texture = gl::createTextureArray(device, GL_RGBA32UI, kTexelBytes, layered.x,
                                              layered.y, layered.z, operation, "lamina voxels");
        if (!texture)
            return texture.error();
        fresh.texture = std::move(*texture);
        return fresh;
    }
    const std::uint64_t texels = std::uint64_t{layered.x} * layered.y * layered.z;
    if (texels > device->limits.maxTextureBufferTexels)
        return Error{ErrorCode::DeviceLimit,
                     operation + ": needs a texel buffer of " + std::to_string(texels) +
                         " texels, the device's limit is " +
                         std::to_string(device->limits.maxTextureBufferTexels) +
                         "; use a smaller grid"};
    auto buffer = gl::createBuffer(device, texels * kTexelBytes, nullptr, GL_DYNAMIC_STORAGE_BIT,
                                   operation, "lamina voxels");
    if (!buffer)
        return buffer.error();
    fresh.texture = gl::Texture::create(device, "lamina voxels", GL_TEXTURE_BUFFER);
    fresh.buffer = std::move(*buffer);
    device->gl.TextureBuffer(fresh.texture.id(), GL_RGBA32UI, fresh.buffer.id());
    return fresh;
}

void VoxelGrid::Impl::assign(const GridTransform& place, std::shared_ptr<gl::Texture> newRanges) {
    const bool isLocal = newRanges != nullptr;
    if (!transform || !(*transform == place) || isLocal != (ranges != nullptr)) {
        const GridBlock block = makeGridBlock(place, isLocal);
        const std::size_t used =
            offsetof(GridBlock, boundaries) + place.sliceBoundaries().size() * sizeof(float);
        device->gl.NamedBufferSubData(uniforms.id(), 0, static_cast<GLsizeiptr>(used), &block);
    }
    transform = place;
    ranges = std::move(newRanges);
}

void VoxelGrid::Impl::uploadRanges(std::span<const ColumnRange> columns) const {
    std::vector<glm::vec2> texels(columns.size());
    std::ranges::transform(columns, texels.begin(), [](const ColumnRange& range) {
        return glm::vec2(range.near, -range.far);
    });
    device->gl.TextureSubImage2D(ranges->id(), 0, 0, 0, static_cast<GLsizei>(words.size.x),
                                 static_cast<GLsizei>(words.size.y), GL_RG, GL_FLOAT,
                                 texels.data());
}

std::vector<ColumnRange> VoxelGrid::Impl::downloadRanges() const {
    std::vector<ColumnRange> columns(std::size_t{words.size.x} * words.size.y);
    // At most 16384 x 16384 texels of 8 bytes: GL takes 32-bit sizes.
    const auto rows = std::min(words.size.y, (1u << 27u) / words.size.x);
    for (std::uint32_t y = 0; y < words.size.y; y += rows) {
        const std::uint32_t count = std::min(rows, words.size.y - y);
        const std::size_t texels = std::size_t{count} * words.size.x;
        device->gl.GetTextureSubImage(ranges->id(), 0, 0, static_cast<GLint>(y), 0,
                                      static_cast<GLsizei>(words.size.x),
                                      static_cast<GLsizei>(count), 1, GL_RG, GL_FLOAT,
                                      static_cast<GLsizei>(texels * sizeof(ColumnRange)),
                                      columns.data() + std::size_t{y} * words.size.x);
    }
    for (ColumnRange& range : columns)
        range.far = -range.far;
    return columns;
}

VoxelGrid::VoxelGrid(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;
VoxelGrid::~VoxelGrid() = default;

Result<VoxelGrid> VoxelGrid::create(const Device& device, VoxelStore store) {
    auto impl = std::make_unique<Impl>();
    impl->words.store = store;
    impl->device = device.state();
    auto uniforms = gl::createBuffer(impl->device, sizeof(GridBlock), nullptr,
                                     GL_DYNAMIC_STORAGE_BIT, "voxel grid", "lamina grid constants");
    if (!uniforms)
        return uniforms.error();
    impl->uniforms = std::move(*uniforms);
    return VoxelGrid(std::move(impl));
}

Result<void> VoxelGrid::resize(const GridTransform& transform) {
    return resize(transform, mImpl->words.store);
}

Result<void> VoxelGrid::resize(const GridTransform& transform, VoxelStore store,
                               SliceRanges ranges) {
    return resizeAll({this, 1}, transform, store, ranges);
}

Result<void> VoxelGrid::resizeAll(std::span<VoxelGrid> grids, const GridTransform& transform,
                                  VoxelStore store, SliceRanges ranges) {
    if (grids.empty())
        return {};
    const glm::uvec3 size = transform.size();
    const glm::uvec3 layered{size.x, size.y,
                             (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup};
    if (transform.sliceBoundaries().size() > LAMINA_MAX_SLICE_BOUNDARIES)
        return Error{ErrorCode::DeviceLimit,
                     "voxel grid: needs " + std::to_string(size.z) +
                         " slices of custom or logarithmic distribution, the limit is " +
                         std::to_string(LAMINA_MAX_SLICE_BOUNDARIES - 1) +
                         "; use fewer slices or a linear distribution"};
    const std::string operation = "voxel grid " + transform.describe();

    std::shared_ptr<gl::Texture> map;
    const Impl& first = *grids.front().mImpl;
    if (ranges == SliceRanges::Local) {
        // A map that grids besides these use must keep its values.
        const auto sharing = std::ranges::count_if(
            grids, [&](const VoxelGrid& grid) { return grid.mImpl->ranges == first.ranges; });
        if (first.ranges && first.ranges.use_count() == sharing && first.words.size.x == size.x &&
            first.words.size.y == size.y) {
            map = first.ranges;
        } else {
            auto created = gl::createTexture2d(first.device, GL_RG32F, kRangeBytes, size.x, size.y,
                                               operation, "lamina near/far map");
            if (!created)
                return created.error();
            map = std::make_shared<gl::Texture>(std::move(*created));
        }
    }

    std::vector<std::optional<Impl::Words>> fresh(grids.size());
    for (std::size_t i = 0; i < grids.size(); ++i) {
        const Impl& impl = *grids[i].mImpl;
        if (layered == impl.words.size && store == impl.words.store)
            continue;
        auto allocated = impl.allocate(store, layered, operation);
        if (!allocated)
            return allocated.error();
        fresh[i] = std::move(*allocated);
    }
    for (std::size_t i = 0; i < grids.size(); ++i) {
        if (fresh[i])
            grids[i].mImpl->words = std::move(*fresh[i]);
        grids[i].mImpl->assign(transform, map);
    }
    return {};
}

Result<void> VoxelGrid::upload(const BitGrid& bits) {
    const SliceRanges ranges = bits.hasLocalRanges() ? SliceRanges::Local : SliceRanges::Uniform;
    if (auto resized = resize(bits.transform(), mImpl->words.store, ranges); !resized)
        return resized;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: upload voxels");
    const gl::PixelUnpackGuard guard(device);
    if (bits.hasLocalRanges())
        mImpl->uploadRanges(bits.ranges());
    if (mImpl->words.store == VoxelStore::Buffer) {
        device.gl.NamedBufferSubData(mImpl->words.buffer.id(), 0,
                                     static_cast<GLsizeiptr>(bits.words().size_bytes()),
                                     bits.words().data());
        return {};
    }
    const glm::uvec3 size = mImpl->words.size;
    device.gl.TextureSubImage3D(mImpl->words.texture.id(), 0, 0, 0, 0, static_cast<GLsizei>(size.x),
                                static_cast<GLsizei>(size.y), static_cast<GLsizei>(size.z),
                                GL_RGBA_INTEGER, GL_UNSIGNED_INT, bits.words().data());
    return {};
}

Result<BitGrid> VoxelGrid::download() const {
    if (!mImpl->transform)
        return Error{
            ErrorCode::InvalidArgument,
            "voxel grid: expected voxels to download, found a grid of no size; voxelize into it "
            "first"};
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: download voxels");
    const gl::PixelPackGuard guard(device);
    auto bits = mImpl->ranges ? BitGrid::create(*mImpl->transform, mImpl->downloadRanges())
                              : BitGrid::create(*mImpl->transform);
    if (!bits)
        return bits;
    if (mImpl->words.store == VoxelStore::Buffer) {
        device.gl.GetNamedBufferSubData(mImpl->words.buffer.id(), 0,
                                        static_cast<GLsizeiptr>(bits->words().size_bytes()),
                                        bits->words().data());
        return bits;
    }
    // GL takes the size in bytes as a 32-bit integer, too small for the largest grids: band by
    // band.
    const glm::uvec3 size = mImpl->words.size;
    const std::size_t rowWords = std::size_t{size.x} * 4;
    const auto bandRows = static_cast<std::uint32_t>((std::size_t{1} << 28) / rowWords);
    for (std::uint32_t layer = 0; layer < size.z; ++layer)
        for (std::uint32_t y = 0; y < size.y; y += bandRows) {
            const std::uint32_t rows = std::min(bandRows, size.y - y);
            const std::size_t first = (std::size_t{layer} * size.y + y) * rowWords;
            device.gl.GetTextureSubImage(
                mImpl->words.texture.id(), 0, 0, static_cast<GLint>(y), static_cast<GLint>(layer),
                static_cast<GLsizei>(size.x), static_cast<GLsizei>(rows), 1, GL_RGBA_INTEGER,
                GL_UNSIGNED_INT, static_cast<GLsizei>(rows * rowWords * sizeof(std::uint32_t)),
                bits->words().data() + first);
        }
    return bits;
}

void VoxelGrid::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit,
                     std::uint32_t grid, std::optional<std::uint32_t> rangeTextureUnit) const {
    if (!mImpl->transform)
        return;
    const GladGLContext& gl = mImpl->device->gl;
    const GLuint buffer = mImpl->uniforms.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding + grid, 1, &buffer);
    gl.BindTextureUnit(textureUnit + grid, mImpl->words.texture.id());
    gl.BindSampler(textureUnit + grid, 0);
    if (mImpl->ranges) {
        const GLuint unit =
            rangeTextureUnit.value_or(textureUnit + LAMINA_GRID_DEFAULT_RANGE_UNIT) + grid;
        gl.BindTextureUnit(unit, mImpl->ranges->id());
        gl.BindSampler(unit, 0);
    }
}

const GridTransform* VoxelGrid::transform() const {
    return mImpl->transform ? &*mImpl->transform : nullptr;
}
VoxelStore VoxelGrid::store() const {
    return mImpl->words.store;
}
std::uint32_t VoxelGrid::texture() const {
    return mImpl->words.texture.id();
}
std::uint32_t VoxelGrid::buffer() const {
    return mImpl->words.buffer.id();
}
bool VoxelGrid::hasLocalRanges() const {
    return mImpl->ranges != nullptr;
}
std::uint32_t VoxelGrid::rangeTexture() const {
    return mImpl->ranges ? mImpl->ranges->id() : 0;
}
std::uint32_t VoxelGrid::uniformBuffer() const {
    return mImpl->uniforms.id();
}
const gl::DeviceState* VoxelGrid::deviceState() const {
    return mImpl->device.get();
}
std::uint64_t VoxelGrid::gpuBytes() const {
    return mImpl->uniforms.bytes() + mImpl->words.texture.bytes() + mImpl->words.buffer.bytes() +
           (mImpl->ranges ? mImpl->ranges->bytes() : 0);
}

} // namespace lamina
