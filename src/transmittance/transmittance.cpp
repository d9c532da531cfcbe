#include <lamina/transmittance/transmittance.hpp>

#include "gl/binding_guards.hpp"
#include "gl/fetch_sampler.hpp"
#include "gl/program_cache.hpp"
#include "gl/screen_pass.hpp"
#include "gl/view_constants.hpp"
#include "transmittance/absorption_sums.hpp"
#include "transmittance/opaque_map.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

namespace lamina {
namespace {

constexpr float kWidestFilter = 7.0f;
/// Of a stand-in for log2(0): 2^(n * kNoLight) is 0 for every share of a leaf that matters.
constexpr float kNoLight = -1e4f;
constexpr double kLeafBias = 1.0 / 5000.0;
constexpr double kOpaqueBias = 1.0 / 1000.0;
constexpr GLuint kApplyBlocks = LAMINA_TRANSMITTANCE_APPLY_BLOCK_BINDING;

Error invalid(const std::string& text) {
    return Error{ErrorCode::InvalidArgument, "transmittance: " + text};
}

Result<void> check(const TransmittanceDesc& desc) {
    if (desc.maxFaces < 1 || desc.maxFaces > LAMINA_TRANSMITTANCE_MAX_FACES)
        return invalid("expected 1 to 6 faces, found " + std::to_string(desc.maxFaces));
    const bool isCount = desc.model == TransmittanceModel::LeafCount;
    if (desc.classes < 1 || desc.maxFaces * desc.classes > LAMINA_TRANSMITTANCE_MAX_CLASSES)
        return invalid("expected at least one class and at most 8 grids, found " +
                       std::to_string(desc.classes) + " classes times " +
                       std::to_string(desc.maxFaces) + " faces; use fewer of either");
    if (!isCount && (desc.classes > 1 || desc.localRanges))
        return invalid("expected one class and no local ranges of the absorption model, found " +
                       std::to_string(desc.classes) + " classes" +
                       (desc.localRanges ? " and local ranges" : ""));
    if (desc.opaqueMapTexels == 0)
        return invalid("expected an opaque shadow map of at least 1 texel, found 0");
    return {};
}

Result<void> check(const TransmittanceSettings& settings) {
    for (const glm::vec3& sigma : settings.attenuation)
        for (int channel = 0; channel < 3; ++channel)
            if (!(sigma[channel] >= 0.0f && sigma[channel] <= 1.0f))
                return invalid("expected an attenuation in [0,1], found " +
                               std::to_string(sigma[channel]));
    for (const float width : {settings.filterWidth, settings.opaqueFilterWidth})
        if (!(width >= 0.0f && width <= kWidestFilter))
            return invalid("expected filter widths from 0 to 7, found " + std::to_string(width));
    if (settings.depthBias && !std::isfinite(*settings.depthBias))
        return invalid("expected a finite depth bias, found " +
                       std::to_string(*settings.depthBias));
    if (!(settings.absorptionScale >= 0.0f) || !std::isfinite(settings.absorptionScale))
        return invalid("expected a finite absorption scale of at least 0, found " +
                       std::to_string(settings.absorptionScale));
    return {};
}

} // namespace

struct Transmittance::Impl {
    /// What counts leaves: a slicemap a face and class.
    struct LeafMaps {
        std::unique_ptr<Voxelizer> voxelizer;
        std::vector<VoxelGrid> grids; ///< By face, then class.
    };

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
    [[nodiscard]] Result<void> buildLeafMaps(const TransmittanceCasters& casters,
                                             TransmittanceStats& stats);
    [[nodiscard]] Result<void> buildSums(const TransmittanceCasters& casters,
                                         TransmittanceStats& stats);
    [[nodiscard]] std::uint32_t gridCount() const { return desc.maxFaces * desc.classes; }
    [[nodiscard]] shared::LaminaTransmittanceConstants makeConstants() const;
    void uploadConstants();
    void bind(GLuint uniformBufferBinding, GLuint textureUnit);
    [[nodiscard]] Result<GLuint> program(int normals) const;
    [[nodiscard]] Result<void> checkTexture(GLuint texture, const View& view,
                                            const char* role) const;
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
    LeafMaps leafMaps;
    // A leaf is one voxel of a column however steep it is: what counts is the number of leaves.
    auto voxelizer = Voxelizer::create(host, {.backend = Backend::MrtSlicemap,
                                              .coverage = Coverage::Sampled,
                                              .localRanges = desc.localRanges,
                                              .store = VoxelStore::Texture});
    if (!voxelizer)
        return voxelizer.error();
    leafMaps.voxelizer = std::move(*voxelizer);
    for (std::uint32_t i = 0; i < gridCount(); ++i) {
        auto grid = VoxelGrid::create(host);
        if (!grid)
            return grid.error();
        leafMaps.grids.push_back(std::move(*grid));
    }
    maps = std::move(leafMaps);
    return {};
}

Result<void> Transmittance::Impl::buildLeafMaps(const TransmittanceCasters& casters,
                                                TransmittanceStats& stats) {
    auto& leafMaps = std::get<LeafMaps>(maps);
    const Material fallback;
    VoxelizeOptions options;
    if (desc.classes > 1) {
        options.split = Split::ColorClass;
        options.materials = casters.materials.empty() ? std::span(&fallback, 1) : casters.materials;
    }
    for (std::size_t face = 0; face < faces.grids.size(); ++face) {
        auto voxelized = leafMaps.voxelizer->voxelizeWith(
            casters.leaves, faces.grids[face], options,
            std::span(leafMaps.grids).subspan(face * desc.classes, desc.classes));
        if (!voxelized)
            return voxelized.error();
        stats.passes += voxelized->passes;
        stats.meshTriangles = voxelized->meshTriangles;
    }
    return {};
}

Result<void> Transmittance::Impl::buildSums(const TransmittanceCasters& casters,
                                            TransmittanceStats& stats) {
    std::vector<GeometrySource> all(casters.leaves.begin(), casters.leaves.end());
    all.insert(all.end(), casters.opaque.begin(), casters.opaque.end());
    const Material fallback;
    auto built = std::get<AbsorptionSums>(maps).build(
        all, casters.materials.empty() ? std::span(&fallback, 1) : casters.materials, faces);
    if (!built)
        return built.error();
    stats.passes = built->passes;
    stats.meshTriangles = built->meshTriangles;
    return {};
}

shared::LaminaTransmittanceConstants Transmittance::Impl::makeConstants() const {
    shared::LaminaTransmittanceConstants block{};
    const glm::dvec3 direction = glm::length(light.direction) > 0.0
                                     ? glm::normalize(light.direction)
                                     : glm::dvec3(0.0, -1.0, 0.0);
    constexpr float kNoCone = -2.0f;
    block.light = light.kind == LightKind::Directional ? glm::vec4(glm::dvec4(-direction, 0.0))
                                                       : glm::vec4(glm::dvec4(light.position, 1.0));
    block.cone = {glm::vec3(direction), light.kind == LightKind::Spot
                                            ? static_cast<float>(std::cos(light.coneAngle))
                                            : kNoCone};
    double depths = 0.0;
    for (const GridTransform& grid : faces.grids)
        depths = std::max(depths, grid.farDepth() - grid.nearDepth());
    block.lookup = {settings.filterWidth, settings.opaqueFilterWidth,
                    settings.depthBias.value_or(static_cast<float>(kLeafBias * depths)),
                    settings.depthBias.value_or(static_cast<float>(kOpaqueBias * depths))};
    block.scalars.x = settings.absorptionScale;
    block.modes.x = desc.classes;
    if (settings.slices == SliceLookup::Linear)
        block.modes.y |= LAMINA_TRANSMITTANCE_LINEAR_SLICES;
    if (settings.absorptionForm == AbsorptionForm::Linear)
        block.modes.y |= LAMINA_TRANSMITTANCE_LINEAR_FORM;
    for (int axis = 0; axis < 6; ++axis)
        block.gridFaces[axis / 4][axis % 4] = faces.ofAxis[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < settings.attenuation.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            block.attenuation[i][channel] =
                std::max(std::log2(1.0f - settings.attenuation[i][channel]), kNoLight);
    opaqueMap.describe(block);
    return block;
}

void Transmittance::Impl::uploadConstants() {
    if (!isDirty)
        return;
    const auto block = makeConstants();
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
    // Faces that this light does not need get the first one's grids: no binding stays empty.
    const auto faceOf = [&](std::uint32_t face) { return face < faces.grids.size() ? face : 0; };
    if (const auto* sums = std::get_if<AbsorptionSums>(&maps)) {
        bindTexture(LAMINA_TRANSMITTANCE_SUM_UNIT, sums->texture());
        for (std::uint32_t face = 0; face < desc.maxFaces; ++face) {
            const GLuint grid = sums->gridBlock(faceOf(face));
            gl.BindBuffersBase(GL_UNIFORM_BUFFER, firstGridBlock + face, 1, &grid);
        }
        return;
    }
    const auto& leafMaps = std::get<LeafMaps>(maps);
    const GLuint words = textureUnit + LAMINA_TRANSMITTANCE_WORD_UNIT;
    for (std::uint32_t i = 0; i < gridCount(); ++i)
        leafMaps.grids[faceOf(i / desc.classes) * desc.classes + i % desc.classes].bind(
            firstGridBlock, words, i, words + gridCount());
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

Result<void> Transmittance::Impl::checkTexture(GLuint texture, const View& view,
                                               const char* role) const {
    const GladGLContext& gl = device->gl;
    GLint target = 0, width = 0, height = 0;
    if (gl.IsTexture(texture)) {
        gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
        gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
        gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_HEIGHT, &height);
    }
    if (target == GL_TEXTURE_2D && glm::uvec2(width, height) == view.size)
        return {};
    return invalid("expected a 2D texture of the view's " + std::to_string(view.size.x) + " x " +
                   std::to_string(view.size.y) + " pixels as " + role + ", found " +
                   (target == GL_TEXTURE_2D
                        ? "one of " + std::to_string(width) + " x " + std::to_string(height)
                        : "the name " + std::to_string(texture) + ", which is none"));
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
    for (const VoxelGrid& grid : std::get<LeafMaps>(maps).grids)
        bytes += grid.gpuBytes();
    return bytes;
}

Transmittance::Transmittance(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
Transmittance::Transmittance(Transmittance&&) noexcept = default;
Transmittance& Transmittance::operator=(Transmittance&&) noexcept = default;
Transmittance::~Transmittance() = default;

Result<Transmittance> Transmittance::create(const Device& device, const TransmittanceDesc& desc) {
    if (auto valid = check(desc); !valid)
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
    if (auto valid = check(settings); !valid)
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
    auto built = mImpl->desc.model == TransmittanceModel::LeafCount
                     ? mImpl->buildLeafMaps(casters, stats)
                     : mImpl->buildSums(casters, stats);
    if (!built)
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
        return invalid("expected prepared maps to apply, found none; call prepare() first");
    auto view = makeViewConstants(receiver.view, "transmittance");
    if (!view)
        return view.error();
    if (auto valid = mImpl->checkTexture(receiver.depthTexture, receiver.view, "depth"); !valid)
        return valid;
    if (auto valid = mImpl->checkTexture(target, receiver.view, "target"); !valid)
        return valid;
    int normals = LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH;
    if (receiver.normalTexture != 0) {
        if (auto valid = mImpl->checkTexture(receiver.normalTexture, receiver.view, "normals");
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
    return LAMINA_TRANSMITTANCE_GRID_BLOCKS + mImpl->gridCount();
}

std::uint32_t Transmittance::textureUnitCount() const {
    if (mImpl->desc.model == TransmittanceModel::Absorption)
        return LAMINA_TRANSMITTANCE_WORD_UNIT;
    return LAMINA_TRANSMITTANCE_WORD_UNIT + mImpl->gridCount() * (mImpl->desc.localRanges ? 2 : 1);
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
