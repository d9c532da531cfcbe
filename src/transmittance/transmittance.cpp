#include <lamina/transmittance/transmittance.hpp>

#include "gl/binding_guards.hpp"
#include "gl/fetch_sampler.hpp"
#include "gl/host_texture.hpp"
#include "gl/program_cache.hpp"
#include "gl/screen_pass.hpp"
#include "gl/view_constants.hpp"
#include "transmittance/absorption_sums.hpp"
#include "transmittance/leaf_maps.hpp"
#include "transmittance/opaque_map.hpp"
#include "transmittance/settings.hpp"

#include <variant>
#include <vector>

namespace lamina {
namespace {

constexpr GLuint kApplyBlocks = LAMINA_TRANSMITTANCE_APPLY_BLOCK_BINDING;

enum class TextureRole : std::uint8_t { Normals, Target };

} // namespace

struct Transmittance::Impl {
    std::shared_ptr<gl::DeviceState> device;
    TransmittanceDesc desc;
    TransmittanceSettings settings;
    std::variant<std::monostate, LeafMaps, AbsorptionSums> maps;
    OpaqueMap opaqueMap;
    gl::ScreenPass screenPass;
    gl::FetchSampler sampler; ///< For the host's depths and normals.
    gl::Buffer constants;
    gl::Buffer viewConstants;
    gl::Texture target;
    glm::uvec2 targetSize{0};
    TransmittanceLight light;
    LightFaces faces;
    bool isPrepared = false;
    bool isDirty = true;

    Impl(const Device& host, const TransmittanceDesc& wanted)
        : device(host.state())
        , desc(wanted)
        , opaqueMap(device, desc.opaqueMapTexels)
        , screenPass(device, "lamina transmittance")
        , sampler(device) {}

    [[nodiscard]] Result<void> createMaps(const Device& host);
    [[nodiscard]] Result<void> buildMaps(const TransmittanceCasters& casters,
                                         TransmittanceStats& stats);
    void uploadConstants();
    void bind(GLuint uniformBufferBinding, GLuint textureUnit);
    [[nodiscard]] Result<GLuint> program(int normals) const;
    [[nodiscard]] Result<void> checkColors(GLuint texture, const View& view,
                                           TextureRole role) const;
    [[nodiscard]] Result<void> reserveTarget(const glm::uvec2& size);
    [[nodiscard]] std::uint64_t gpuBytes() const;
};

Result<void> Transmittance::Impl::createMaps(const Device& host) {
    if (desc.model == TransmittanceModel::Absorption) {
        auto sums = AbsorptionSums::create(host, desc.maxFaces);
        if (!sums)
            return sums.error();
        maps = std::move(*sums);
        return {};
    }
    auto leafMaps = LeafMaps::create(host, desc);
    if (!leafMaps)
        return leafMaps.error();
    maps = std::move(*leafMaps);
    return {};
}

Result<void> Transmittance::Impl::buildMaps(const TransmittanceCasters& casters,
                                            TransmittanceStats& stats) {
    const Material fallback;
    const std::span<const Material> materials =
        casters.materials.empty() ? std::span(&fallback, 1) : casters.materials;
    if (auto* leafMaps = std::get_if<LeafMaps>(&maps))
        return leafMaps->build(casters.leaves, materials, faces, stats);
    std::vector<GeometrySource> all(casters.leaves.begin(), casters.leaves.end());
    all.insert(all.end(), casters.opaque.begin(), casters.opaque.end());
    auto built = std::get<AbsorptionSums>(maps).build(all, materials, faces);
    if (!built)
        return built.error();
    stats.passes = built->passes;
    stats.meshTriangles = built->meshTriangles;
    return {};
}

void Transmittance::Impl::uploadConstants() {
    if (!isDirty)
        return;
    auto block = makeTransmittanceConstants(desc, settings, light, faces);
    opaqueMap.describe(block);
    device->gl.NamedBufferSubData(constants.id(), 0, sizeof block, &block);
    isDirty = false;
}

void Transmittance::Impl::bind(GLuint uniformBufferBinding, GLuint textureUnit) {
    const GladGLContext& gl = device->gl;
    uploadConstants();
    const GLuint block = constants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding, 1, &block);
    const auto bindTexture = [&](GLuint unit, GLuint texture) {
        gl.BindTextureUnit(textureUnit + unit, texture);
        gl.BindSampler(textureUnit + unit, 0);
    };
    bindTexture(LAMINA_TRANSMITTANCE_OPAQUE_UNIT, opaqueMap.texture());
    const GLuint firstGridBlock = uniformBufferBinding + LAMINA_TRANSMITTANCE_GRID_BLOCKS;
    if (const auto* leafMaps = std::get_if<LeafMaps>(&maps)) {
        const GLuint words = textureUnit + LAMINA_TRANSMITTANCE_WORD_UNIT;
        leafMaps->bind(firstGridBlock, words, words + desc.maxFaces);
        return;
    }
    const auto& sums = std::get<AbsorptionSums>(maps);
    bindTexture(LAMINA_TRANSMITTANCE_SUM_UNIT, sums.texture());
    for (std::uint32_t face = 0; face < desc.maxFaces; ++face) {
        // Faces that this light does not need get the first one's grid: no binding stays empty.
        const GLuint grid = sums.gridBlock(face < faces.grids.size() ? face : 0);
        gl.BindBuffersBase(GL_UNIFORM_BUFFER, firstGridBlock + face, 1, &grid);
    }
}

Result<GLuint> Transmittance::Impl::program(int normals) const {
    return gl::findOrBuildProgram(
        *device,
        {"lamina transmittance",
         {{GL_VERTEX_SHADER, "gl/screen.vert"}, {GL_FRAGMENT_SHADER, "transmittance/apply.frag"}},
         {{"LAMINA_TRANSMITTANCE_NORMALS", std::to_string(normals)},
          {"LAMINA_TRANSMITTANCE_MODEL", std::to_string(static_cast<int>(desc.model))},
          {"LAMINA_TRANSMITTANCE_FACES", std::to_string(desc.maxFaces)},
          {"LAMINA_TRANSMITTANCE_CLASSES", std::to_string(desc.classes)},
          {"LAMINA_TRANSMITTANCE_LOCAL_RANGES", desc.localRanges ? "1" : "0"}}});
}

Result<void> Transmittance::Impl::checkColors(GLuint texture, const View& view,
                                              TextureRole role) const {
    const GladGLContext& gl = device->gl;
    const bool isTarget = role == TextureRole::Target;
    const auto invalid = [&](const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     std::string("transmittance: expected ") + (isTarget ? "a target" : "normals") +
                         " in a 2D texture of the view's " + std::to_string(view.size.x) + " x " +
                         std::to_string(view.size.y) + " pixels, of a " +
                         (isTarget ? "colour-renderable " : "") +
                         "float or normalized format, found " + found};
    };
    if (!gl.IsTexture(texture))
        return invalid("no texture of name " + std::to_string(texture));
    const auto level = [&](GLenum name) {
        GLint value = 0;
        gl.GetTextureLevelParameteriv(texture, 0, name, &value);
        return value;
    };
    GLint target = 0;
    gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
    if (target != GL_TEXTURE_2D)
        return invalid("a texture of target " + std::to_string(target));
    const glm::uvec2 size(level(GL_TEXTURE_WIDTH), level(GL_TEXTURE_HEIGHT));
    if (size != view.size)
        return invalid(std::to_string(size.x) + " x " + std::to_string(size.y) + " pixels");
    const GLint type = level(GL_TEXTURE_RED_TYPE);
    GLint isRenderable = GL_TRUE;
    if (isTarget)
        gl.GetInternalformativ(GL_TEXTURE_2D,
                               static_cast<GLenum>(level(GL_TEXTURE_INTERNAL_FORMAT)),
                               GL_COLOR_RENDERABLE, 1, &isRenderable);
    // Mesa (22.3) calls formats of a shared exponent renderable, but cannot draw to them.
    if (isTarget && level(GL_TEXTURE_SHARED_SIZE) != 0)
        isRenderable = GL_FALSE;
    if (isRenderable == GL_FALSE ||
        (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED && type != GL_SIGNED_NORMALIZED))
        return invalid("another format");
    return {};
}

Result<void> Transmittance::Impl::reserveTarget(const glm::uvec2& size) {
    if (size == targetSize)
        return {};
    auto texture = gl::createTexture2d(device, GL_RGBA16F, 8, size.x, size.y, "transmittance",
                                       "lamina transmittance");
    if (!texture)
        return texture.error();
    target = std::move(*texture);
    targetSize = size;
    return {};
}

std::uint64_t Transmittance::Impl::gpuBytes() const {
    std::uint64_t bytes =
        opaqueMap.gpuBytes() + constants.bytes() + viewConstants.bytes() + target.bytes();
    if (const auto* sums = std::get_if<AbsorptionSums>(&maps))
        return bytes + sums->gpuBytes();
    return bytes + std::get<LeafMaps>(maps).gpuBytes();
}

Transmittance::Transmittance(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
Transmittance::Transmittance(Transmittance&&) noexcept = default;
Transmittance& Transmittance::operator=(Transmittance&&) noexcept = default;
Transmittance::~Transmittance() = default;

Result<Transmittance> Transmittance::create(const Device& device, const TransmittanceDesc& desc) {
    if (auto valid = checkTransmittance(desc); !valid)
        return valid.error();
    auto impl = std::make_unique<Impl>(device, desc);
    if (auto created = impl->createMaps(device); !created)
        return created.error();
    struct Block {
        gl::Buffer& buffer;
        std::size_t bytes;
    };
    for (const Block& block : {Block{impl->constants, sizeof(shared::LaminaTransmittanceConstants)},
                               Block{impl->viewConstants, sizeof(shared::LaminaViewConstants)}}) {
        auto buffer = gl::createBuffer(impl->device, block.bytes, nullptr, GL_DYNAMIC_STORAGE_BIT,
                                       "transmittance", "lamina transmittance constants");
        if (!buffer)
            return buffer.error();
        block.buffer = std::move(*buffer);
    }
    if (auto built = impl->program(LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH); !built)
        return built.error();
    return Transmittance(std::move(impl));
}

Result<void> Transmittance::setSettings(const TransmittanceSettings& settings) {
    if (auto valid = checkTransmittance(settings); !valid)
        return valid;
    mImpl->settings = settings;
    mImpl->isDirty = true;
    return {};
}

const TransmittanceSettings& Transmittance::settings() const {
    return mImpl->settings;
}

Result<TransmittanceStats> Transmittance::prepare(const TransmittanceLight& light,
                                                  const TransmittanceCasters& casters) {
    const gl::DebugGroup group(*mImpl->device, "lamina: prepare transmittance");
    auto faces =
        fitLightFaces(light, casters.bounds, mImpl->desc.size, mImpl->desc.maxFaces, kWidestFilter);
    if (!faces)
        return faces.error();
    mImpl->isPrepared = false;
    mImpl->isDirty = true;
    mImpl->light = light;
    mImpl->faces = std::move(*faces);
    TransmittanceStats stats;
    stats.faces = static_cast<std::uint32_t>(mImpl->faces.grids.size());
    if (auto built = mImpl->buildMaps(casters, stats); !built)
        return built.error();
    Result<void> drawn;
    if (casters.opaqueMap)
        drawn = mImpl->opaqueMap.copy(*casters.opaqueMap, light);
    else if (casters.opaque.empty())
        mImpl->opaqueMap.clear();
    else
        drawn = mImpl->opaqueMap.draw(casters.opaque, mImpl->faces);
    if (!drawn)
        return drawn.error();
    mImpl->isPrepared = true;
    stats.gpuBytes = mImpl->gpuBytes();
    return stats;
}

Result<std::uint32_t> Transmittance::apply(const TransmittanceReceiver& receiver) {
    if (auto view = viewpoint(receiver.view); !view)
        return view.error();
    if (auto reserved = mImpl->reserveTarget(receiver.view.size); !reserved)
        return reserved.error();
    if (auto applied = apply(receiver, mImpl->target.id()); !applied)
        return applied.error();
    return mImpl->target.id();
}

Result<void> Transmittance::apply(const TransmittanceReceiver& receiver, std::uint32_t target) {
    if (!mImpl->isPrepared)
        return Error{
            ErrorCode::InvalidArgument,
            "transmittance: expected prepared maps to apply, found none; call prepare() first"};
    auto view = makeViewConstants(receiver.view, "transmittance");
    if (!view)
        return view.error();
    if (auto depths = gl::depthStep(*mImpl->device, receiver.depthTexture, receiver.view.size,
                                    "transmittance");
        !depths)
        return depths.error();
    if (auto valid = mImpl->checkColors(target, receiver.view, TextureRole::Target); !valid)
        return valid;
    if (auto valid = checkTransmittance(receiver.normalEncoding); !valid)
        return valid;
    if (target == receiver.depthTexture || target == receiver.normalTexture)
        return Error{ErrorCode::InvalidArgument,
                     std::string("transmittance: expected a target that is not read, found the ") +
                         (target == receiver.depthTexture ? "depth" : "normal") + " texture " +
                         std::to_string(target) + "; draw to another one"};
    int normals = LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH;
    if (receiver.normalTexture != 0) {
        if (auto valid =
                mImpl->checkColors(receiver.normalTexture, receiver.view, TextureRole::Normals);
            !valid)
            return valid;
        normals = receiver.normalEncoding == NormalEncoding::Signed
                      ? LAMINA_TRANSMITTANCE_NORMALS_SIGNED
                      : LAMINA_TRANSMITTANCE_NORMALS_UNSIGNED;
    }
    auto program = mImpl->program(normals);
    if (!program)
        return program.error();

    gl::DeviceState& device = *mImpl->device;
    const GladGLContext& gl = device.gl;
    const gl::DebugGroup group(device, "lamina: apply transmittance");
    const gl::TextureUnitGuard textures(
        device, 0, LAMINA_TRANSMITTANCE_APPLY_TEXTURE_UNIT + textureUnitCount());
    const gl::IndexedBufferBindings uniforms(gl, GL_UNIFORM_BUFFER,
                                             kApplyBlocks + uniformBufferCount());
    gl.NamedBufferSubData(mImpl->viewConstants.id(), 0, sizeof *view, &*view);
    const GLuint viewBlock = mImpl->viewConstants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_TRANSMITTANCE_APPLY_VIEW_BINDING, 1, &viewBlock);
    gl.BindTextureUnit(LAMINA_TRANSMITTANCE_APPLY_DEPTH_UNIT, receiver.depthTexture);
    gl.BindTextureUnit(LAMINA_TRANSMITTANCE_APPLY_NORMAL_UNIT, receiver.normalTexture);
    gl.BindSampler(LAMINA_TRANSMITTANCE_APPLY_DEPTH_UNIT, mImpl->sampler.id());
    gl.BindSampler(LAMINA_TRANSMITTANCE_APPLY_NORMAL_UNIT, mImpl->sampler.id());
    mImpl->bind(kApplyBlocks, LAMINA_TRANSMITTANCE_APPLY_TEXTURE_UNIT);
    mImpl->screenPass.draw(*program, {&target, 1}, receiver.view.size);
    uniforms.restore(gl);
    return {};
}

std::string Transmittance::shaderDefines(std::uint32_t uniformBufferBinding,
                                         std::uint32_t textureUnit) const {
    const TransmittanceDesc& desc = mImpl->desc;
    const auto line = [](const char* name, std::uint32_t value) {
        return "#define LAMINA_TRANSMITTANCE_" + std::string(name) + ' ' + std::to_string(value) +
               '\n';
    };
    return line("MODEL", static_cast<std::uint32_t>(desc.model)) + line("FACES", desc.maxFaces) +
           line("CLASSES", desc.classes) + line("LOCAL_RANGES", desc.localRanges ? 1 : 0) +
           line("BLOCK_BINDING", uniformBufferBinding) + line("TEXTURE_UNIT", textureUnit);
}

std::uint32_t Transmittance::uniformBufferCount() const {
    return LAMINA_TRANSMITTANCE_GRID_BLOCKS + mImpl->desc.maxFaces;
}

std::uint32_t Transmittance::textureUnitCount() const {
    if (mImpl->desc.model == TransmittanceModel::Absorption)
        return LAMINA_TRANSMITTANCE_WORD_UNIT;
    return LAMINA_TRANSMITTANCE_WORD_UNIT +
           mImpl->desc.maxFaces * (mImpl->desc.localRanges ? 2 : 1);
}

void Transmittance::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit) {
    if (mImpl->isPrepared)
        mImpl->bind(uniformBufferBinding, textureUnit);
}

const TransmittanceDesc& Transmittance::desc() const {
    return mImpl->desc;
}

std::uint64_t Transmittance::gpuBytes() const {
    return mImpl->gpuBytes();
}

} // namespace lamina
