#include "gl/device_state.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/epipolar_constants.hpp"

#include <lamina/voxelize/epipolar_grid.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

namespace lamina {
namespace {

/// How many tiles of `tile` texels stand side by side for `count` of them: as few as the device's
/// limit allows. Rows of a tile are then close together in memory, which the scan walks.
glm::uvec2 arrange(std::uint32_t count, const glm::uvec2& tile, std::uint32_t maxTexels) {
    const std::uint32_t mostRows = std::max(maxTexels / tile.y, 1u);
    const std::uint32_t columns = (count + mostRows - 1) / mostRows;
    return {columns, (count + columns - 1) / columns};
}

Error noVolumes(const char* operation) {
    return {ErrorCode::InvalidArgument,
            std::string(operation) +
                ": expected a grid with shadow volumes, found one without; voxelize into it first"};
}

} // namespace

struct EpipolarGrid::Impl {
    std::shared_ptr<gl::DeviceState> device;
    EpipolarLayout layout;
    std::vector<EpipolarTransform> transforms;
    gl::Texture words;
    gl::Buffer spaces;
    std::uint32_t capacity = 0; ///< Shadow volumes that `words` and `spaces` have room for.
    std::uint32_t columns = 1;  ///< Tiles side by side.
    glm::uvec3 tileSize{0};     ///< Texels in x, in y, layers.

    [[nodiscard]] glm::uvec2 tile(std::uint32_t vsv) const {
        return glm::uvec2(vsv % columns, vsv / columns) * glm::uvec2(tileSize);
    }
    Result<void> resize(std::span<const EpipolarTransform> wanted, const EpipolarLayout& as);
    Result<void> allocate(std::uint32_t count, const glm::uvec3& size, const std::string& what);
    void uploadSpaces();
};

Result<void> EpipolarGrid::Impl::allocate(std::uint32_t count, const glm::uvec3& size,
                                          const std::string& what) {
    const glm::uvec2 tiles = arrange(count, glm::uvec2(size), device->limits.maxTextureSize);
    const std::string operation = "epipolar grid of " + std::to_string(count) + " " + what;
    auto newWords =
        gl::createTextureArray(device, GL_RGBA32UI, 16, tiles.x * size.x, tiles.y * size.y, size.z,
                               operation, "lamina shadow volumes");
    if (!newWords)
        return newWords.error();
    auto newSpaces =
        gl::createBuffer(device, count * sizeof(shared::LaminaEpipolarSpace), nullptr,
                         GL_DYNAMIC_STORAGE_BIT, operation, "lamina shadow volume constants");
    if (!newSpaces)
        return newSpaces.error();
    words = std::move(*newWords);
    spaces = std::move(*newSpaces);
    columns = tiles.x;
    capacity = count;
    tileSize = size;
    return {};
}

Result<void> EpipolarGrid::Impl::resize(std::span<const EpipolarTransform> wanted,
                                        const EpipolarLayout& as) {
    if (auto sound = checkEpipolarLayout(wanted, as); !sound)
        return sound;
    const glm::uvec3 size = wanted.front().size();
    const glm::uvec3 texels(size.x, size.y, (size.z + as.bitsPerTexel - 1) / as.bitsPerTexel);
    const auto count = static_cast<std::uint32_t>(wanted.size());
    if (texels != tileSize || count > capacity)
        if (auto allocated = allocate(count, texels, wanted.front().describe()); !allocated)
            return allocated;
    layout = as;
    transforms.assign(wanted.begin(), wanted.end());
    uploadSpaces();
    return {};
}

void EpipolarGrid::Impl::uploadSpaces() {
    std::vector<shared::LaminaEpipolarSpace> content;
    content.reserve(transforms.size());
    for (std::uint32_t vsv = 0; vsv < transforms.size(); ++vsv)
        content.push_back(makeEpipolarSpace(transforms[vsv], layout, tile(vsv)));
    device->gl.NamedBufferSubData(spaces.id(), 0,
                                  static_cast<GLsizeiptr>(content.size() * sizeof content[0]),
                                  content.data());
}

EpipolarGrid::EpipolarGrid(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
EpipolarGrid::EpipolarGrid(EpipolarGrid&&) noexcept = default;
EpipolarGrid& EpipolarGrid::operator=(EpipolarGrid&&) noexcept = default;
EpipolarGrid::~EpipolarGrid() = default;

Result<EpipolarGrid> EpipolarGrid::create(const Device& device, const EpipolarLayout& layout) {
    if (auto sound = checkEpipolarLayout(layout); !sound)
        return sound.error();
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    impl->layout = layout;
    return EpipolarGrid(std::move(impl));
}

Result<void> EpipolarGrid::resize(std::span<const EpipolarTransform> transforms) {
    return mImpl->resize(transforms, mImpl->layout);
}

Result<void> EpipolarGrid::upload(const EpipolarBits& bits) {
    if (auto resized = mImpl->resize(bits.transforms(), bits.layout()); !resized)
        return resized;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: upload shadow volumes");
    const gl::PixelUnpackGuard guard(device);
    const glm::ivec3 size(mImpl->tileSize);
    for (std::uint32_t vsv = 0; vsv < bits.transforms().size(); ++vsv) {
        const glm::ivec2 tile(mImpl->tile(vsv));
        device.gl.TextureSubImage3D(mImpl->words.id(), 0, tile.x, tile.y, 0, size.x, size.y, size.z,
                                    GL_RGBA_INTEGER, GL_UNSIGNED_INT,
                                    bits.words().data() + bits.texelIndex(vsv, 0, 0, 0));
    }
    return {};
}

Result<EpipolarBits> EpipolarGrid::download() const {
    if (mImpl->transforms.empty())
        return noVolumes("download of shadow volumes");
    auto bits = EpipolarBits::create(mImpl->transforms, mImpl->layout);
    if (!bits)
        return bits;
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: download shadow volumes");
    const gl::PixelPackGuard guard(device);
    const glm::ivec3 size(mImpl->tileSize);
    const auto layerBytes = static_cast<GLsizei>(16 * size.x * size.y);
    for (std::uint32_t vsv = 0; vsv < mImpl->transforms.size(); ++vsv) {
        const glm::ivec2 tile(mImpl->tile(vsv));
        for (int layer = 0; layer < size.z; ++layer)
            device.gl.GetTextureSubImage(
                mImpl->words.id(), 0, tile.x, tile.y, layer, size.x, size.y, 1, GL_RGBA_INTEGER,
                GL_UNSIGNED_INT, layerBytes,
                bits->words().data() +
                    bits->texelIndex(vsv, 0, 0, static_cast<std::uint32_t>(layer)));
    }
    return bits;
}

void EpipolarGrid::bind(std::uint32_t storageBinding, std::uint32_t textureUnit) const {
    if (mImpl->transforms.empty())
        return;
    const GladGLContext& gl = mImpl->device->gl;
    const GLuint buffer = mImpl->spaces.id();
    // Multi-bind leaves the host's generic storage buffer binding alone.
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, storageBinding, 1, &buffer);
    gl.BindTextureUnit(textureUnit, mImpl->words.id());
    gl.BindSampler(textureUnit, 0);
}

std::span<const EpipolarTransform> EpipolarGrid::transforms() const {
    return mImpl->transforms;
}
const EpipolarLayout& EpipolarGrid::layout() const {
    return mImpl->layout;
}
glm::uvec2 EpipolarGrid::tile(std::uint32_t vsv) const {
    assert(vsv < mImpl->transforms.size());
    return mImpl->tile(vsv);
}
std::uint32_t EpipolarGrid::groupCount() const {
    return mImpl->tileSize.z;
}
std::uint32_t EpipolarGrid::texture() const {
    return mImpl->words.id();
}
std::uint32_t EpipolarGrid::buffer() const {
    return mImpl->spaces.id();
}
const gl::DeviceState* EpipolarGrid::deviceState() const {
    return mImpl->device.get();
}
std::uint64_t EpipolarGrid::gpuBytes() const {
    return mImpl->words.bytes() + mImpl->spaces.bytes();
}

} // namespace lamina
