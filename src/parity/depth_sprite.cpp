#include "gl/state_guard.hpp"
#include "parity/depth_sprite_data.hpp"
#include "parity/parity_constants.hpp"

#include <lamina/parity/depth_sprite.hpp>

#include <new>
#include <string>
#include <utility>

namespace lamina {
namespace {

Error notBuilt(const char* operation) {
    return {ErrorCode::InvalidArgument,
            std::string(operation) + ": expected a sprite that was built, found one of no size; "
                                     "give it to SpriteBuilder::build() first"};
}

} // namespace

namespace detail {

Result<gl::Texture> DepthSpriteData::allocate(const GridTransform& wanted,
                                              std::uint32_t wantedLayers) const {
    const glm::uvec3 size = wanted.size();
    if (transform && glm::uvec2(transform->size()) == glm::uvec2(size) && layers == wantedLayers)
        return gl::Texture();
    auto created = gl::createTextureArray(
        device, GL_R32F, sizeof(float), size.x, size.y, wantedLayers + 1,
        "depth sprite of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
            " columns, " + std::to_string(wantedLayers) + " layers",
        "lamina depth sprite");
    if (!created)
        return created;
    const GladGLContext& gl = device->gl;
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl.TextureParameteri(created->id(), axis, GL_CLAMP_TO_BORDER);
    constexpr GLfloat kBorder[] = {LAMINA_PARITY_NO_LAYER, 0.0f, 0.0f, 0.0f};
    gl.TextureParameterfv(created->id(), GL_TEXTURE_BORDER_COLOR, kBorder);
    return created;
}

SpriteReport downloadReport(const gl::DeviceState& device, const gl::Buffer& report) {
    shared::LaminaSpriteReport found{};
    device.gl.GetNamedBufferSubData(report.id(), 0, sizeof found, &found);
    return {found.layers, found.oddColumns, found.overflowColumns,
            std::uint64_t{found.crossingsHigh} << 32u | found.crossingsLow};
}

Result<gl::Buffer> createReportBuffer(const std::shared_ptr<gl::DeviceState>& device) {
    return gl::createBuffer(device, sizeof(shared::LaminaSpriteReport), nullptr, 0, "depth sprite",
                            "lamina sprite report");
}

} // namespace detail

DepthSprite::DepthSprite(std::unique_ptr<detail::DepthSpriteData> data)
    : mData(std::move(data)) {}
DepthSprite::DepthSprite(DepthSprite&&) noexcept = default;
DepthSprite& DepthSprite::operator=(DepthSprite&&) noexcept = default;
DepthSprite::~DepthSprite() = default;

Result<DepthSprite> DepthSprite::create(const Device& device) {
    auto data = std::make_unique<detail::DepthSpriteData>();
    data->device = device.state();
    auto report = detail::createReportBuffer(data->device);
    if (!report)
        return report.error();
    data->report = std::move(*report);
    return DepthSprite(std::move(data));
}

const GridTransform* DepthSprite::transform() const {
    // Also of a moved-from sprite, which sets and downloads then refuse.
    return mData && mData->transform ? &*mData->transform : nullptr;
}
std::uint32_t DepthSprite::layers() const {
    return mData->layers;
}
std::uint32_t DepthSprite::texture() const {
    return mData->texture.id();
}
std::uint64_t DepthSprite::gpuBytes() const {
    return mData->texture.bytes() + mData->report.bytes();
}

std::uint64_t DepthSprite::bytesFor(const GridTransform& transform, std::uint32_t layers) {
    return sizeof(float) * std::uint64_t{transform.size().x} * transform.size().y *
               (std::uint64_t{layers} + 1) +
           sizeof(shared::LaminaSpriteReport);
}

Result<SpriteReport> DepthSprite::downloadReport() const {
    if (!transform())
        return notBuilt("sprite report");
    return detail::downloadReport(*mData->device, mData->report);
}

Result<SpriteLayers> DepthSprite::download() const {
    if (!transform())
        return notBuilt("download of a depth sprite");
    gl::DeviceState& device = *mData->device;
    const glm::uvec3 size = mData->transform->size();
    const std::size_t layerTexels = std::size_t{size.x} * size.y;
    std::vector<float> depths;
    try {
        depths.resize(layerTexels * mData->layers);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "download of a depth sprite: the host could not give " +
                         std::to_string(layerTexels * mData->layers * sizeof(float)) +
                         " bytes; use fewer columns"};
    }
    const gl::DebugGroup group(device, "lamina: download depth sprite");
    const gl::PixelPackGuard guard(device);
    // Layer by layer: GL takes the size in bytes as a 32-bit integer.
    for (std::uint32_t layer = 0; layer < mData->layers; ++layer)
        device.gl.GetTextureSubImage(
            mData->texture.id(), 0, 0, 0, static_cast<GLint>(layer), static_cast<GLsizei>(size.x),
            static_cast<GLsizei>(size.y), 1, GL_RED, GL_FLOAT,
            static_cast<GLsizei>(layerTexels * sizeof(float)), depths.data() + layer * layerTexels);
    return SpriteLayers::create(*mData->transform, mData->layers, std::move(depths));
}

} // namespace lamina
