#include "gl/device_state.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"

#include <lamina/grid/voxel_grid.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

namespace lamina {
namespace {

constexpr std::uint32_t kTexelBytes = 16;

} // namespace

std::string_view name(VoxelStore store) {
    return store == VoxelStore::Texture ? "texture" : "buffer";
}

struct VoxelGrid::Impl {
    std::shared_ptr<gl::DeviceState> device;
    VoxelStore store = VoxelStore::Texture;
    gl::Buffer uniforms;
    gl::Texture texture; ///< The words, or a view of `buffer`.
    gl::Buffer buffer;   ///< The words, in the buffer store.
    glm::uvec3 size{0};  ///< Columns x, columns y, layers.
    std::optional<GridTransform> transform;

    [[nodiscard]] Result<void> allocateTexture(const glm::uvec3& layered,
                                               const std::string& operation);
    [[nodiscard]] Result<void> allocateBuffer(const glm::uvec3& layered,
                                              const std::string& operation);
};

Result<void> VoxelGrid::Impl::allocateTexture(const glm::uvec3& layered,
                                              const std::string& operation) {
    auto words = gl::createTextureArray(device, GL_RGBA32UI, kTexelBytes, layered.x, layered.y,
                                        layered.z, operation, "lamina voxels");
    if (!words)
        return words.error();
    texture = std::move(*words);
    buffer = {};
    return {};
}

Result<void> VoxelGrid::Impl::allocateBuffer(const glm::uvec3& layered,
                                             const std::string& operation) {
    const std::uint64_t texels = std::uint64_t{layered.x} * layered.y * layered.z;
    if (texels > device->limits.maxTextureBufferTexels)
        return Error{ErrorCode::DeviceLimit,
                     operation + ": needs a texel buffer of " + std::to_string(texels) +
                         " texels, the device's limit is " +
                         std::to_string(device->limits.maxTextureBufferTexels) +
                         "; use a smaller grid"};
    auto words = gl::createBuffer(device, texels * kTexelBytes, nullptr, GL_DYNAMIC_STORAGE_BIT,
                                  operation, "lamina voxels");
    if (!words)
        return words.error();
    texture = gl::Texture::create(device, "lamina voxels", GL_TEXTURE_BUFFER);
    buffer = std::move(*words);
    device->gl.TextureBuffer(texture.id(), GL_RGBA32UI, buffer.id());
    return {};
}

VoxelGrid::VoxelGrid(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;
VoxelGrid::~VoxelGrid() = default;

Result<VoxelGrid> VoxelGrid::create(const Device& device, VoxelStore store) {
    auto impl = std::make_unique<Impl>();
    impl->store = store;
    impl->device = device.state();
    auto uniforms = gl::createBuffer(impl->device, sizeof(GridBlock), nullptr,
                                     GL_DYNAMIC_STORAGE_BIT, "voxel grid", "lamina grid constants");
    if (!uniforms)
        return uniforms.error();
    impl->uniforms = std::move(*uniforms);
    return VoxelGrid(std::move(impl));
}

Result<void> VoxelGrid::resize(const GridTransform& transform) {
    return resize(transform, mImpl->store);
}

Result<void> VoxelGrid::resize(const GridTransform& transform, VoxelStore store) {
    const glm::uvec3 size = transform.size();
    const glm::uvec3 layered{size.x, size.y,
                             (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup};
    if (transform.sliceBoundaries().size() > LAMINA_MAX_SLICE_BOUNDARIES)
        return Error{ErrorCode::DeviceLimit,
                     "voxel grid: needs " + std::to_string(size.z) +
                         " slices of custom or logarithmic distribution, the limit is " +
                         std::to_string(LAMINA_MAX_SLICE_BOUNDARIES - 1) +
                         "; use fewer slices or a linear distribution"};
    if (layered != mImpl->size || store != mImpl->store) {
        const std::string operation = "voxel grid " + transform.describe();
        auto allocated = store == VoxelStore::Texture ? mImpl->allocateTexture(layered, operation)
                                                      : mImpl->allocateBuffer(layered, operation);
        if (!allocated)
            return allocated;
        mImpl->size = layered;
        mImpl->store = store;
    }
    if (!mImpl->transform || !(*mImpl->transform == transform)) {
        const GridBlock block = makeGridBlock(transform);
        const std::size_t used =
            offsetof(GridBlock, boundaries) + transform.sliceBoundaries().size() * sizeof(float);
        mImpl->device->gl.NamedBufferSubData(mImpl->uniforms.id(), 0, static_cast<GLsizeiptr>(used),
                                             &block);
    }
    mImpl->transform = transform;
    return {};
}

Result<void> VoxelGrid::upload(const BitGrid& bits) {
    if (auto resized = resize(bits.transform()); !resized)
        return resized;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: upload voxels");
    if (mImpl->store == VoxelStore::Buffer) {
        device.gl.NamedBufferSubData(mImpl->buffer.id(), 0,
                                     static_cast<GLsizeiptr>(bits.words().size_bytes()),
                                     bits.words().data());
        return {};
    }
    const gl::PixelUnpackGuard guard(device);
    const glm::uvec3 size = mImpl->size;
    device.gl.TextureSubImage3D(mImpl->texture.id(), 0, 0, 0, 0, static_cast<GLsizei>(size.x),
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
    auto bits = BitGrid::create(*mImpl->transform);
    if (!bits)
        return bits;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: download voxels");
    if (mImpl->store == VoxelStore::Buffer) {
        device.gl.GetNamedBufferSubData(mImpl->buffer.id(), 0,
                                        static_cast<GLsizeiptr>(bits->words().size_bytes()),
                                        bits->words().data());
        return bits;
    }
    const gl::PixelPackGuard guard(device);
    // GL takes the size in bytes as a 32-bit integer, too small for the largest grids: band by
    // band.
    const glm::uvec3 size = mImpl->size;
    const std::size_t rowWords = std::size_t{size.x} * 4;
    const auto bandRows = static_cast<std::uint32_t>((std::size_t{1} << 28) / rowWords);
    for (std::uint32_t layer = 0; layer < size.z; ++layer)
        for (std::uint32_t y = 0; y < size.y; y += bandRows) {
            const std::uint32_t rows = std::min(bandRows, size.y - y);
            const std::size_t first = (std::size_t{layer} * size.y + y) * rowWords;
            device.gl.GetTextureSubImage(
                mImpl->texture.id(), 0, 0, static_cast<GLint>(y), static_cast<GLint>(layer),
                static_cast<GLsizei>(size.x), static_cast<GLsizei>(rows), 1, GL_RGBA_INTEGER,
                GL_UNSIGNED_INT, static_cast<GLsizei>(rows * rowWords * sizeof(std::uint32_t)),
                bits->words().data() + first);
        }
    return bits;
}

void VoxelGrid::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit,
                     std::uint32_t grid) const {
    if (!mImpl->transform)
        return;
    const GladGLContext& gl = mImpl->device->gl;
    const GLuint buffer = mImpl->uniforms.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding + grid, 1, &buffer);
    gl.BindTextureUnit(textureUnit + grid, mImpl->texture.id());
    gl.BindSampler(textureUnit + grid, 0);
}

const GridTransform* VoxelGrid::transform() const {
    return mImpl->transform ? &*mImpl->transform : nullptr;
}
VoxelStore VoxelGrid::store() const {
    return mImpl->store;
}
std::uint32_t VoxelGrid::texture() const {
    return mImpl->texture.id();
}
std::uint32_t VoxelGrid::buffer() const {
    return mImpl->buffer.id();
}
std::uint32_t VoxelGrid::uniformBuffer() const {
    return mImpl->uniforms.id();
}
std::uint64_t VoxelGrid::gpuBytes() const {
    return mImpl->uniforms.bytes() + mImpl->texture.bytes() + mImpl->buffer.bytes();
}

} // namespace lamina
