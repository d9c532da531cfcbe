#include "gl/device_state.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"

#include <lamina/grid/voxel_grid.hpp>

#include <algorithm>
#include <optional>
#include <string>

namespace lamina {

struct VoxelGrid::Impl {
    std::shared_ptr<gl::DeviceState> device;
    gl::Buffer uniforms;
    gl::Texture words;
    glm::uvec3 textureSize{0}; ///< Columns x, columns y, layers.
    std::optional<GridTransform> transform;
};

VoxelGrid::VoxelGrid(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;
VoxelGrid::~VoxelGrid() = default;

Result<VoxelGrid> VoxelGrid::create(const Device& device) {
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    auto uniforms = gl::createBuffer(impl->device, sizeof(GridBlock), nullptr,
                                     GL_DYNAMIC_STORAGE_BIT, "voxel grid", "lamina grid constants");
    if (!uniforms)
        return uniforms.error();
    impl->uniforms = std::move(*uniforms);
    return VoxelGrid(std::move(impl));
}

Result<void> VoxelGrid::resize(const GridTransform& transform) {
    const glm::uvec3 size = transform.size();
    const glm::uvec3 textureSize{
        size.x, size.y, (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup};
    if (transform.sliceBoundaries().size() > LAMINA_MAX_SLICE_BOUNDARIES)
        return Error{ErrorCode::DeviceLimit,
                     "voxel grid: needs " + std::to_string(size.z) +
                         " slices of custom or logarithmic distribution, the limit is " +
                         std::to_string(LAMINA_MAX_SLICE_BOUNDARIES - 1) +
                         "; use fewer slices or a linear distribution"};
    if (textureSize != mImpl->textureSize) {
        auto words = gl::createTextureArray(mImpl->device, GL_RGBA32UI, 16, textureSize.x,
                                            textureSize.y, textureSize.z,
                                            "voxel grid " + transform.describe(), "lamina voxels");
        if (!words)
            return words.error();
        mImpl->words = std::move(*words);
        mImpl->textureSize = textureSize;
    }
    if (!mImpl->transform || !(*mImpl->transform == transform)) {
        const GridBlock block = makeGridBlock(transform);
        const std::size_t used =
            offsetof(GridBlock, boundaries) + transform.sliceBoundaries().size() * sizeof(float);
        mImpl->device->gl.NamedBufferSubData(mImpl->uniforms.id(), 0,
                                             static_cast<GLsizeiptr>(used), &block);
    }
    mImpl->transform = transform;
    return {};
}

Result<void> VoxelGrid::upload(const BitGrid& bits) {
    if (auto resized = resize(bits.transform()); !resized)
        return resized;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: upload voxels");
    const gl::PixelUnpackGuard guard(device);
    const glm::uvec3 size = mImpl->textureSize;
    device.gl.TextureSubImage3D(mImpl->words.id(), 0, 0, 0, 0, static_cast<GLsizei>(size.x),
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
    const gl::PixelPackGuard guard(device);
    // GL takes the size in bytes as a 32-bit integer, too small for the largest grids: band by
    // band.
    const glm::uvec3 size = mImpl->textureSize;
    const std::size_t rowWords = std::size_t{size.x} * 4;
    const auto bandRows = static_cast<std::uint32_t>((std::size_t{1} << 28) / rowWords);
    for (std::uint32_t layer = 0; layer < size.z; ++layer)
        for (std::uint32_t y = 0; y < size.y; y += bandRows) {
            const std::uint32_t rows = std::min(bandRows, size.y - y);
            const std::size_t first = (std::size_t{layer} * size.y + y) * rowWords;
            device.gl.GetTextureSubImage(
                mImpl->words.id(), 0, 0, static_cast<GLint>(y), static_cast<GLint>(layer),
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
    gl.BindTextureUnit(textureUnit + grid, mImpl->words.id());
    gl.BindSampler(textureUnit + grid, 0);
}

const GridTransform* VoxelGrid::transform() const {
    return mImpl->transform ? &*mImpl->transform : nullptr;
}
std::uint32_t VoxelGrid::texture() const {
    return mImpl->words.id();
}
std::uint32_t VoxelGrid::uniformBuffer() const {
    return mImpl->uniforms.id();
}
std::uint64_t VoxelGrid::gpuBytes() const {
    return mImpl->uniforms.bytes() + mImpl->words.bytes();
}

} // namespace lamina
