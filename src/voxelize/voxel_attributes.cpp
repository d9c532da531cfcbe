#include "voxelize/voxel_attributes_impl.hpp"

#include "voxelize/attribute_constants.hpp"

#include <glm/geometric.hpp>
#include <glm/packing.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string>

namespace lamina {
namespace {

using Record = std::array<std::uint32_t, LAMINA_RECORD_WORDS>;

/// The unit vector of a pair of signed 16-bit numbers.
glm::vec3 octahedral(std::uint32_t packed) {
    const glm::vec2 p = glm::unpackSnorm2x16(packed);
    glm::vec3 v(p, 1.0f - std::abs(p.x) - std::abs(p.y));
    const float fold = std::max(-v.z, 0.0f);
    v.x += v.x >= 0.0f ? -fold : fold;
    v.y += v.y >= 0.0f ? -fold : fold;
    return glm::normalize(v);
}

Error tooManyVoxels(const gl::DeviceState& device, std::uint64_t voxels) {
    return {ErrorCode::DeviceLimit, "voxel attributes: expected at most " +
                                        std::to_string(device.limits.maxTextureBufferTexels) +
                                        " set voxels, the texels of a texel buffer here, found " +
                                        std::to_string(voxels) + "; use a smaller grid"};
}

} // namespace

Result<void> VoxelAttributes::Impl::reserve(std::uint64_t voxels) {
    // An empty texel buffer is an error in GL.
    const std::uint64_t wanted = std::max<std::uint64_t>(voxels, 1);
    if (wanted > device->limits.maxTextureBufferTexels)
        return tooManyVoxels(*device, voxels);
    constexpr std::uint64_t kRecordBytes = sizeof(Record);
    if (records.bytes() < wanted * kRecordBytes) {
        auto buffer = gl::createBuffer(device, wanted * kRecordBytes, nullptr, 0,
                                       "attributes of " + std::to_string(voxels) + " voxels",
                                       "lamina voxel records");
        if (!buffer)
            return buffer.error();
        records = std::move(*buffer);
        recordTexture = gl::Texture::create(device, "lamina voxel records", GL_TEXTURE_BUFFER);
    }
    device->gl.TextureBufferRange(recordTexture.id(), GL_RGBA32UI, records.id(), 0,
                                  static_cast<GLsizeiptr>(wanted * kRecordBytes));
    capacity = voxels;
    return {};
}

VoxelAttributes::VoxelAttributes(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VoxelAttributes::VoxelAttributes(VoxelAttributes&&) noexcept = default;
VoxelAttributes& VoxelAttributes::operator=(VoxelAttributes&&) noexcept = default;
VoxelAttributes::~VoxelAttributes() = default;

Result<VoxelAttributes> VoxelAttributes::create(const Device& device,
                                                const VoxelAttributesDesc& desc) {
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    impl->desc = desc;
    if (desc.maxVoxels > impl->device->limits.maxTextureBufferTexels)
        return tooManyVoxels(*impl->device, desc.maxVoxels);
    return VoxelAttributes(std::move(impl));
}

Result<AttributeGrid> VoxelAttributes::download() const {
    if (!mImpl->transform)
        return Error{ErrorCode::InvalidArgument,
                     "voxel attributes: expected attributes to download, found none; call "
                     "AttributeVoxelizer::voxelize() first"};
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: download voxel attributes");
    const std::uint64_t count = readVoxelCount(device, mImpl->ranks);
    if (count > mImpl->capacity)
        return Error{ErrorCode::DeviceLimit,
                     "voxel attributes: expected at most " + std::to_string(mImpl->capacity) +
                         " set voxels, as VoxelAttributesDesc::maxVoxels says, found " +
                         std::to_string(count) + "; give a larger number, or 0"};
    try {
        AttributeGrid grid;
        grid.colors.resize(count);
        grid.normals.resize(count);
        grid.hits.resize(count);
        grid.materials.resize(count);
        // Piece by piece: half the memory.
        constexpr std::size_t kPiece = std::size_t{1} << 20;
        std::vector<Record> records(std::min<std::size_t>(count, kPiece));
        for (std::size_t first = 0; first < count; first += records.size()) {
            const std::size_t size = std::min<std::size_t>(records.size(), count - first);
            device.gl.GetNamedBufferSubData(
                mImpl->records.id(), static_cast<GLintptr>(first * sizeof(Record)),
                static_cast<GLsizeiptr>(size * sizeof(Record)), records.data());
            for (std::size_t i = 0; i < size; ++i) {
                const Record& record = records[i];
                const std::uint32_t color = record[LAMINA_RECORD_COLOR];
                grid.colors[first + i] =
                    glm::u8vec4(color, color >> 8u, color >> 16u, color >> 24u);
                if (record[LAMINA_RECORD_NORMAL] != LAMINA_NO_NORMAL)
                    grid.normals[first + i] = octahedral(record[LAMINA_RECORD_NORMAL]);
                grid.hits[first + i] = record[LAMINA_RECORD_HITS];
                grid.materials[first + i] =
                    static_cast<std::uint16_t>(record[LAMINA_RECORD_MATERIAL]);
            }
        }
        return grid;
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory, "voxel attributes: not enough host memory for " +
                                                 std::to_string(count) +
                                                 " voxels; use a smaller grid"};
    }
}

void VoxelAttributes::bind(std::uint32_t textureUnit) const {
    if (!mImpl->transform)
        return;
    const GladGLContext& gl = mImpl->device->gl;
    gl.BindTextureUnit(textureUnit, mImpl->ranks.texture.id());
    gl.BindTextureUnit(textureUnit + 1, mImpl->recordTexture.id());
    gl.BindSampler(textureUnit, 0);
    gl.BindSampler(textureUnit + 1, 0);
}

const GridTransform* VoxelAttributes::transform() const {
    return mImpl->transform ? &*mImpl->transform : nullptr;
}

std::uint64_t VoxelAttributes::gpuBytes() const {
    return mImpl->ranks.buffer.bytes() + mImpl->records.bytes();
}

} // namespace lamina
