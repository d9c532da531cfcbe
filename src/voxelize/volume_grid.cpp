#include <lamina/voxelize/volume_grid.hpp>

#include "gl/device_state.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/volume_constants.hpp"
#include "voxelize/volume_formats.hpp"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

namespace lamina {

struct VolumeGrid::Impl {
    std::shared_ptr<gl::DeviceState> device;
    VolumeLayout layout;
    gl::Buffer uniforms;
    std::array<gl::Texture, kVolumePayloadCount> textures;
    glm::uvec3 textureSize{0};
    std::optional<GridTransform> transform;
};

namespace {

using Textures = std::array<gl::Texture, kVolumePayloadCount>;

Result<Textures> createTextures(const std::shared_ptr<gl::DeviceState>& device,
                                const VolumeLayout& layout, const GridTransform& transform) {
    const glm::uvec3 size = transform.size();
    Textures textures;
    for (const VolumePayload payload : kVolumePayloads) {
        const VolumeFormat format = layout.format(payload);
        if (format == VolumeFormat::None)
            continue;
        const VolumeFormatInfo gl = info(format);
        auto texture = gl::createTexture3d(
            device, gl.internalFormat, gl.bytesPerTexel, size.x, size.y, size.z,
            "volume " + transform.describe() + " " + std::string(gl.name), "lamina volume");
        if (!texture)
            return texture.error();
        textures[indexOf(payload)] = std::move(*texture);
    }
    return textures;
}

/// Reads a texture as `type` values, `channels` a texel, slice by slice: GL takes byte counts as
/// 32-bit integers, too small for large volumes.
template<class Value>
std::vector<Value> readTexels(gl::DeviceState& device, GLuint texture, const glm::uvec3& size,
                              std::uint32_t channels, GLenum format, GLenum type) {
    const std::size_t sliceValues = std::size_t{size.x} * size.y * channels;
    std::vector<Value> values(sliceValues * size.z);
    const std::size_t rowBytes = std::size_t{size.x} * channels * sizeof(Value);
    const auto bandRows = static_cast<std::uint32_t>(
        std::min<std::size_t>(std::max<std::size_t>((1u << 30) / rowBytes, 1), size.y));
    for (std::uint32_t z = 0; z < size.z; ++z)
        for (std::uint32_t y = 0; y < size.y; y += bandRows) {
            const std::uint32_t rows = std::min(bandRows, size.y - y);
            device.gl.GetTextureSubImage(
                texture, 0, 0, static_cast<GLint>(y), static_cast<GLint>(z),
                static_cast<GLsizei>(size.x), static_cast<GLsizei>(rows), 1, format, type,
                static_cast<GLsizei>(rows * rowBytes),
                values.data() + z * sliceValues + std::size_t{y} * size.x * channels);
        }
    return values;
}

/// The hits of a texel, and whether they reach what its format counts.
struct Hits {
    float count = 0.0f;
    bool saturated = false;
};

Hits hitsOf(const glm::vec4& texel, VolumeFormat format) {
    switch (format) {
    case VolumeFormat::RGBA8:
        return {std::round(texel.a * 255.0f), texel.a >= 1.0f};
    case VolumeFormat::RGBA16F:
        return {texel.a, texel.a >= 2048.0f};
    default:
        return {texel.a, texel.a >= 16777216.0f};
    }
}

/// Calls visit(voxel index, texel as a mean of rgb, hits) for each voxel with hits, and counts
/// those at the ceiling.
template<class Visitor>
std::uint64_t decodeMeans(std::span<const float> texels, VolumeFormat format, Visitor&& visit) {
    std::uint64_t saturated = 0;
    for (std::size_t i = 0; i < texels.size() / 4; ++i) {
        const glm::vec4 texel(texels[4 * i], texels[4 * i + 1], texels[4 * i + 2],
                              texels[4 * i + 3]);
        const Hits hits = hitsOf(texel, format);
        if (hits.count == 0.0f)
            continue;
        saturated += hits.saturated ? 1 : 0;
        visit(i, format == VolumeFormat::RGBA8 ? glm::vec3(texel) : glm::vec3(texel) / hits.count);
    }
    return saturated;
}

glm::vec3 decodeNormal(glm::vec3 mean, VolumeFormat format) {
    if (format == VolumeFormat::RGBA8)
        mean = mean * 2.0f - 1.0f;
    const float size = glm::length(mean);
    return size > static_cast<float>(LAMINA_VOLUME_CANCELLED_NORMAL) ? mean / size
                                                                     : glm::vec3(0.0f);
}

/// Texture unit of a payload, counted from the first one of the volume.
GLuint unitOf(VolumePayload payload, VolumeFormat format) {
    switch (payload) {
    case VolumePayload::Count:
        return format == VolumeFormat::R8 ? LAMINA_VOLUME_UNIT_COUNT_R8
                                          : LAMINA_VOLUME_UNIT_COUNT_R32UI;
    case VolumePayload::Absorption:
        return LAMINA_VOLUME_UNIT_ABSORPTION;
    case VolumePayload::Normal:
        return LAMINA_VOLUME_UNIT_NORMAL;
    case VolumePayload::Color:
        return LAMINA_VOLUME_UNIT_COLOR;
    case VolumePayload::Optics:
        return LAMINA_VOLUME_UNIT_OPTICS;
    }
    return 0;
}

glm::vec2 decodeOptics(const glm::vec3& mean, VolumeFormat format) {
    if (format != VolumeFormat::RGBA8)
        return {mean.x, mean.y};
    return {1.0f + mean.x * static_cast<float>(LAMINA_VOLUME_INDEX_RANGE), mean.y};
}

} // namespace

VolumeGrid::VolumeGrid(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
VolumeGrid::VolumeGrid(VolumeGrid&&) noexcept = default;
VolumeGrid& VolumeGrid::operator=(VolumeGrid&&) noexcept = default;
VolumeGrid::~VolumeGrid() = default;

Result<VolumeGrid> VolumeGrid::create(const Device& device, const VolumeLayout& layout) {
    if (auto valid = checkLayout(layout); !valid)
        return valid.error();
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    impl->layout = layout;
    auto uniforms = gl::createBuffer(impl->device, sizeof(VolumeBlock), nullptr,
                                     GL_DYNAMIC_STORAGE_BIT, "volume", "lamina volume constants");
    if (!uniforms)
        return uniforms.error();
    impl->uniforms = std::move(*uniforms);
    return VolumeGrid(std::move(impl));
}

Result<void> VolumeGrid::resize(const GridTransform& transform) {
    if (transform.sliceBoundaries().size() > LAMINA_MAX_SLICE_BOUNDARIES)
        return Error{ErrorCode::DeviceLimit,
                     "volume: needs " + std::to_string(transform.size().z) +
                         " slices of custom or logarithmic distribution, the limit is " +
                         std::to_string(LAMINA_MAX_SLICE_BOUNDARIES - 1) +
                         "; use fewer slices or a linear distribution"};
    if (transform.size() != mImpl->textureSize) {
        auto textures = createTextures(mImpl->device, mImpl->layout, transform);
        if (!textures)
            return textures.error();
        mImpl->textures = std::move(*textures);
        mImpl->textureSize = transform.size();
    }
    if (!mImpl->transform || !(*mImpl->transform == transform)) {
        VolumeBlock block;
        block.constants.grid = makeGridBlock(transform).constants;
        block.constants.payload = {payloadBits(mImpl->layout), resolvedBits(mImpl->layout), 0, 0};
        std::ranges::copy(transform.sliceBoundaries(), block.boundaries.begin());
        const std::size_t used =
            offsetof(VolumeBlock, boundaries) + transform.sliceBoundaries().size() * sizeof(float);
        mImpl->device->gl.NamedBufferSubData(mImpl->uniforms.id(), 0, static_cast<GLsizeiptr>(used),
                                             &block);
    }
    mImpl->transform = transform;
    return {};
}

Result<VolumeData> VolumeGrid::download() const {
    if (!mImpl->transform)
        return Error{ErrorCode::InvalidArgument,
                     "volume: expected voxels to download, found a volume of no size; voxelize "
                     "into it first"};
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: download volume");
    const gl::PixelPackGuard guard(device);
    const glm::uvec3 size = mImpl->textureSize;
    const std::size_t voxelCount = std::size_t{size.x} * size.y * size.z;
    const VolumeLayout& layout = mImpl->layout;
    const auto saturatedOf = [](auto&& values, auto ceiling) {
        return static_cast<std::uint64_t>(
            std::ranges::count_if(values, [=](auto value) { return value >= ceiling; }));
    };
    VolumeData data{*mImpl->transform, {}, {}, {}, {}, {}, {}};
    try {
        if (layout.count == VolumeFormat::R32UI) {
            data.counts = readTexels<std::uint32_t>(device, texture(VolumePayload::Count), size, 1,
                                                    GL_RED_INTEGER, GL_UNSIGNED_INT);
            data.saturatedVoxels[indexOf(VolumePayload::Count)] =
                saturatedOf(data.counts, ~std::uint32_t{0});
        } else if (layout.count == VolumeFormat::R8) {
            const auto bytes = readTexels<std::uint8_t>(device, texture(VolumePayload::Count), size,
                                                        1, GL_RED, GL_UNSIGNED_BYTE);
            data.counts.assign(bytes.begin(), bytes.end());
            data.saturatedVoxels[indexOf(VolumePayload::Count)] =
                saturatedOf(data.counts, std::uint32_t{255});
        }
        if (layout.absorption != VolumeFormat::None) {
            data.absorption = readTexels<float>(device, texture(VolumePayload::Absorption), size, 1,
                                                GL_RED, GL_FLOAT);
            if (layout.absorption == VolumeFormat::R8)
                data.saturatedVoxels[indexOf(VolumePayload::Absorption)] =
                    saturatedOf(data.absorption, 1.0f);
        }
        const auto readMeans = [&](VolumePayload payload, auto& values, auto empty, auto decode) {
            const VolumeFormat format = layout.format(payload);
            if (format == VolumeFormat::None)
                return;
            values.assign(voxelCount, empty);
            const auto texels =
                readTexels<float>(device, texture(payload), size, 4, GL_RGBA, GL_FLOAT);
            data.saturatedVoxels[indexOf(payload)] =
                decodeMeans(texels, format, [&](std::size_t voxel, const glm::vec3& mean) {
                    values[voxel] = decode(mean, format);
                });
        };
        readMeans(VolumePayload::Normal, data.normals, glm::vec3(0.0f), decodeNormal);
        readMeans(VolumePayload::Color, data.colors, glm::vec3(0.0f),
                  [](const glm::vec3& mean, VolumeFormat) { return mean; });
        readMeans(VolumePayload::Optics, data.optics, glm::vec2(1.0f), decodeOptics);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory, "volume: not enough host memory to download " +
                                                 std::to_string(voxelCount) +
                                                 " voxels; use fewer voxels or payloads"};
    }
    return data;
}

void VolumeGrid::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit) const {
    if (!mImpl->transform)
        return;
    const GladGLContext& gl = mImpl->device->gl;
    const GLuint buffer = mImpl->uniforms.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding, 1, &buffer);
    for (const VolumePayload payload : kVolumePayloads) {
        if (mImpl->layout.format(payload) == VolumeFormat::None)
            continue;
        const GLuint unit = textureUnit + unitOf(payload, mImpl->layout.format(payload));
        gl.BindTextureUnit(unit, texture(payload));
        gl.BindSampler(unit, 0);
    }
}

const VolumeLayout& VolumeGrid::layout() const {
    return mImpl->layout;
}
const GridTransform* VolumeGrid::transform() const {
    return mImpl->transform ? &*mImpl->transform : nullptr;
}
std::uint32_t VolumeGrid::texture(VolumePayload payload) const {
    return mImpl->textures[indexOf(payload)].id();
}
std::uint32_t VolumeGrid::uniformBuffer() const {
    return mImpl->uniforms.id();
}
const gl::DeviceState* VolumeGrid::deviceState() const {
    return mImpl->device.get();
}
std::uint64_t VolumeGrid::gpuBytes() const {
    std::uint64_t bytes = mImpl->uniforms.bytes();
    for (const gl::Texture& texture : mImpl->textures)
        bytes += texture.bytes();
    return bytes;
}

} // namespace lamina
