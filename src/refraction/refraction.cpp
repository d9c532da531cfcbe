#include <lamina/refraction/refraction.hpp>

#include "core/check_enumeration.hpp"
#include "gl/binding_guards.hpp"
#include "gl/fetch_sampler.hpp"
#include "gl/screen_pass.hpp"
#include "gl/view_constants.hpp"
#include "refraction/optical_volume.hpp"
#include "refraction/receiver_textures.hpp"
#include "refraction/refraction_constants.hpp"
#include "refraction/refraction_settings.hpp"
#include "refraction/seamless_cube_maps.hpp"

#include <bit>
#include <optional>

namespace lamina {
namespace {

constexpr std::string_view kOperation = "refraction";
constexpr std::uint32_t kLeastVoxels = 8, kMostVoxels = 1024;
static_assert(Refraction::kTextureUnits == LAMINA_REFRACTION_UNITS);

Error invalid(const std::string& text) {
    return Error{ErrorCode::InvalidArgument, "refraction: " + text};
}

} // namespace

struct Refraction::Impl {
    std::shared_ptr<gl::DeviceState> device;
    RefractionDesc desc;
    RefractionSettings settings;
    std::optional<ThicknessMap> thickness;
    std::optional<OpticalVolume> volume;
    gl::ScreenPass screenPass;
    gl::FetchSampler nearest;
    GLuint program = 0, copyProgram = 0;
    gl::Buffer constants;
    gl::Buffer report; ///< shared::LaminaRefractionCounts of the last apply().
    gl::Texture target, behind;
    glm::uvec2 targetSize{0}, behindSize{0};
    std::uint32_t environmentTexture = 0, environmentLevels = 0, environmentSize = 0;
    shared::LaminaRefractionConstants block{};
    GLuint behindDepth = 0;
    bool isPrepared = false, isApplied = false;

    Impl(const Device& host, const RefractionDesc& wanted)
        : device(host.state())
        , desc(wanted)
        , screenPass(device, "lamina refraction")
        , nearest(device) {}

    [[nodiscard]] Result<void> createObjects(const Device& host);
    [[nodiscard]] Result<void> reserve(gl::Texture& texture, glm::uvec2& size,
                                       const glm::uvec2& wanted, bool isMipped);
    [[nodiscard]] Result<void> check(const RefractionReceiver& receiver, GLuint target) const;
    [[nodiscard]] Result<void> copyBehind(const RefractionReceiver& receiver);
    void upload();
    void bind(GLuint uniformBufferBinding, GLuint textureUnit) const;
    [[nodiscard]] bool isReady() const { return isPrepared && environmentTexture != 0; }
};

Result<void> Refraction::Impl::createObjects(const Device& host) {
    if (desc.model == RefractionModel::VolumeIntegral) {
        auto map = ThicknessMap::create(host, desc.thickness);
        if (!map)
            return map.error();
        thickness.emplace(std::move(*map));
    } else {
        auto made = OpticalVolume::create(host, desc.voxels, desc.slabOverlap);
        if (!made)
            return made.error();
        volume.emplace(std::move(*made));
    }
    struct Part {
        GLuint& program;
        const char* shader;
        std::vector<gl::ShaderDefine> defines;
    };
    const Part parts[] = {
        {program,
         "refraction/apply.frag",
         {{"LAMINA_REFRACTION_MODEL", std::to_string(static_cast<int>(desc.model))}}},
        {copyProgram, "refraction/copy.frag", {}},
    };
    for (const Part& part : parts) {
        auto built = gl::findOrBuildProgram(
            *device, {"lamina refraction",
                      {{GL_VERTEX_SHADER, "gl/screen.vert"}, {GL_FRAGMENT_SHADER, part.shader}},
                      part.defines});
        if (!built)
            return built.error();
        part.program = *built;
    }
    auto buffer = gl::createBuffer(device, sizeof block, nullptr, GL_DYNAMIC_STORAGE_BIT,
                                   kOperation, "lamina refraction constants");
    if (!buffer)
        return buffer.error();
    constants = std::move(*buffer);
    auto counts = gl::createBuffer(device, sizeof(shared::LaminaRefractionCounts), nullptr, 0,
                                   kOperation, "lamina refraction report");
    if (!counts)
        return counts.error();
    report = std::move(*counts);
    return {};
}

Result<void> Refraction::Impl::reserve(gl::Texture& texture, glm::uvec2& size,
                                       const glm::uvec2& wanted, bool isMipped) {
    if (size == wanted)
        return {};
    constexpr std::uint32_t kBytes = 8;
    auto made = isMipped ? gl::createMippedTexture2d(device, GL_RGBA16F, kBytes, wanted.x, wanted.y,
                                                     kOperation, "lamina seen behind")
                         : gl::createTexture2d(device, GL_RGBA16F, kBytes, wanted.x, wanted.y,
                                               kOperation, "lamina refraction");
    if (!made)
        return made.error();
    texture = std::move(*made);
    size = wanted;
    return {};
}

Result<void> Refraction::Impl::check(const RefractionReceiver& receiver, GLuint out) const {
    if (!isPrepared)
        return invalid("expected a prepared object to apply, found none; call prepare() first");
    if (environmentTexture == 0)
        return invalid("expected an environment, found none; call setEnvironment() first");
    if (thickness && thickness->size() != receiver.view.size)
        return invalid("expected the view's size that the object was prepared for, found another; "
                       "call prepare() with this view");
    return checkReceiverTextures(device, receiver, out);
}

Result<void> Refraction::Impl::copyBehind(const RefractionReceiver& receiver) {
    if (auto reserved = reserve(behind, behindSize, receiver.view.size, true); !reserved)
        return reserved;
    const GladGLContext& gl = device->gl;
    {
        const gl::TextureUnitGuard textures(*device, 0, 1);
        gl.BindTextureUnit(0, receiver.colorTexture);
        gl.BindSampler(0, nearest.id());
        const GLuint copy = behind.id();
        screenPass.draw(copyProgram, {&copy, 1}, receiver.view.size);
    }
    gl.GenerateTextureMipmap(behind.id());
    return {};
}

void Refraction::Impl::upload() {
    const std::uint32_t kept = block.modes.x;
    writeSettings(settings, desc.model, block);
    block.modes.x |= kept & ~static_cast<std::uint32_t>(LAMINA_REFRACTION_POWER);
    block.modes.y = environmentLevels > 0 ? environmentLevels - 1 : 0;
    block.modes.z = environmentSize;
    device->gl.NamedBufferSubData(constants.id(), 0, sizeof block, &block);
}

void Refraction::Impl::bind(GLuint uniformBufferBinding, GLuint textureUnit) const {
    const GladGLContext& gl = device->gl;
    const GLuint buffer = constants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding, 1, &buffer);
    const auto bindTexture = [&](GLuint unit, GLuint texture, GLuint sampler = 0) {
        gl.BindTextureUnit(textureUnit + unit, texture);
        gl.BindSampler(textureUnit + unit, sampler);
    };
    bindTexture(LAMINA_REFRACTION_ENVIRONMENT_UNIT, environmentTexture);
    bindTexture(LAMINA_REFRACTION_BEHIND_UNIT, behind.id());
    bindTexture(LAMINA_REFRACTION_BEHIND_DEPTH_UNIT, behindDepth, nearest.id());
    if (thickness)
        bindTexture(LAMINA_REFRACTION_THICKNESS_UNIT, thickness->texture());
    else
        volume->bind(textureUnit + LAMINA_REFRACTION_PLANE_UNIT);
}

Refraction::Refraction(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
Refraction::Refraction(Refraction&&) noexcept = default;
Refraction& Refraction::operator=(Refraction&&) noexcept = default;
Refraction::~Refraction() = default;

Result<Refraction> Refraction::create(const Device& device, const RefractionDesc& desc) {
    if (auto known = checkEnumeration(kOperation, "RefractionModel", desc.model,
                                      RefractionModel::ManySurfaces);
        !known)
        return known.error();
    if (desc.voxels < kLeastVoxels || desc.voxels > kMostVoxels)
        return invalid("expected 8 to 1024 voxels a side, found " + std::to_string(desc.voxels));
    const gl::DebugGroup group(*device.state(), "lamina: create refraction");
    auto impl = std::make_unique<Impl>(device, desc);
    if (auto created = impl->createObjects(device); !created)
        return created.error();
    return Refraction(std::move(impl));
}

Result<void> Refraction::setSettings(const RefractionSettings& settings) {
    if (auto valid = checkSettings(settings); !valid)
        return valid;
    mImpl->settings = settings;
    return {};
}

const RefractionSettings& Refraction::settings() const {
    return mImpl->settings;
}

void Refraction::setEnvironment(const Environment& environment) {
    mImpl->environmentTexture = environment.texture();
    mImpl->environmentLevels = environment.levels();
    mImpl->environmentSize = environment.desc().size;
}

Result<RefractionStats> Refraction::prepare(const RefractionObject& object, const View& view) {
    Impl& impl = *mImpl;
    auto constants = makeViewConstants(view, kOperation);
    if (!constants)
        return constants.error();
    const gl::DebugGroup group(*impl.device, "lamina: prepare refraction");
    impl.isPrepared = false;
    impl.isApplied = false;
    RefractionStats stats;
    impl.block.view = *constants;
    impl.block.modes.x = 0;
    if (impl.thickness) {
        const auto built = impl.thickness->build(object.sources, view, object.bounds);
        if (!built)
            return built.error();
        stats.passes = built->passes;
        stats.meshTriangles = built->meshTriangles;
    } else {
        const auto built = impl.volume->build(object.sources, object.materials, object.bounds);
        if (!built)
            return built.error();
        stats.passes = built->passes;
        stats.meshTriangles = built->meshTriangles;
        impl.block.volume = impl.volume->place();
        impl.block.sizes.x = impl.volume->voxels();
        impl.block.optics = impl.volume->sharedOptics().value_or(glm::vec4(1.0f));
        impl.block.modes.x = impl.volume->sharedOptics() ? 0 : LAMINA_REFRACTION_OPTICS;
    }
    impl.isPrepared = true;
    stats.gpuBytes = gpuBytes();
    return stats;
}

Result<std::uint32_t> Refraction::apply(const RefractionReceiver& receiver) {
    if (auto view = viewpoint(receiver.view); !view)
        return invalid(view.error().text);
    if (auto reserved = mImpl->reserve(mImpl->target, mImpl->targetSize, receiver.view.size, false);
        !reserved)
        return reserved.error();
    mImpl->device->gl.ClearTexImage(mImpl->target.id(), 0, GL_RGBA, GL_FLOAT, nullptr);
    if (auto applied = apply(receiver, mImpl->target.id()); !applied)
        return applied.error();
    return mImpl->target.id();
}

Result<void> Refraction::apply(const RefractionReceiver& receiver, std::uint32_t target) {
    Impl& impl = *mImpl;
    const auto view = makeViewConstants(receiver.view, kOperation);
    if (!view)
        return view.error();
    if (auto valid = impl.check(receiver, target); !valid)
        return valid;
    gl::DeviceState& device = *impl.device;
    const GladGLContext& gl = device.gl;
    const gl::DebugGroup group(device, "lamina: apply refraction");
    std::uint32_t flags = impl.block.modes.x & LAMINA_REFRACTION_OPTICS;
    if (receiver.colorTexture != 0) {
        if (auto copied = impl.copyBehind(receiver); !copied)
            return copied;
        flags |= LAMINA_REFRACTION_BEHIND;
        flags |= receiver.colorDepthTexture != 0 ? LAMINA_REFRACTION_BEHIND_DEPTH : 0;
    }
    impl.behindDepth = receiver.colorTexture != 0 ? receiver.colorDepthTexture : 0;
    flags |= receiver.unsignedNormals ? LAMINA_REFRACTION_UNSIGNED_NORMALS : 0;
    flags |= receiver.objectTexture != 0 ? LAMINA_REFRACTION_OBJECTS : 0;
    impl.block.view = *view;
    impl.block.modes.x = flags;
    impl.block.sizes.y = receiver.objectId;
    impl.block.sizes.z = static_cast<std::uint32_t>(
                             std::bit_width(std::max(receiver.view.size.x, receiver.view.size.y))) -
                         1;
    impl.upload();

    const gl::TextureUnitGuard textures(device, 0,
                                        LAMINA_REFRACTION_APPLY_TEXTURE_UNIT + kTextureUnits);
    const gl::IndexedBufferBindings uniforms(gl, GL_UNIFORM_BUFFER, 1);
    const gl::DrawBufferGuard buffers(device, 1);
    const SeamlessCubeMaps seamless(gl);
    const GLuint counts = impl.report.id();
    gl.ClearNamedBufferData(counts, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_REFRACTION_APPLY_REPORT_BINDING, 1,
                       &counts);
    const GLuint inputs[] = {receiver.depthTexture, receiver.normalTexture, receiver.objectTexture};
    for (GLuint unit = 0; unit < 3; ++unit) {
        gl.BindTextureUnit(unit, inputs[unit]);
        gl.BindSampler(unit, impl.nearest.id());
    }
    impl.bind(LAMINA_REFRACTION_APPLY_BLOCK_BINDING, LAMINA_REFRACTION_APPLY_TEXTURE_UNIT);
    impl.screenPass.draw(impl.program, {&target, 1}, receiver.view.size);
    uniforms.restore(gl);
    impl.isApplied = true;
    return {};
}

Result<RefractionReport> Refraction::downloadReport() const {
    if (mImpl->thickness) {
        const auto report = mImpl->thickness->downloadReport();
        if (!report)
            return report.error();
        return RefractionReport{report->openColumns};
    }
    if (!mImpl->isApplied)
        return invalid("expected a shaded object to report on, found none; call apply() first");
    const GladGLContext& gl = mImpl->device->gl;
    shared::LaminaRefractionCounts counts{};
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.GetNamedBufferSubData(mImpl->report.id(), 0, sizeof counts, &counts);
    return RefractionReport{counts.openPixels};
}

const ThicknessMap* Refraction::thicknessMap() const {
    return mImpl->thickness ? &*mImpl->thickness : nullptr;
}

std::string Refraction::shaderDefines(std::uint32_t uniformBufferBinding,
                                      std::uint32_t textureUnit) const {
    const auto line = [](const char* name, std::uint32_t value) {
        return "#define LAMINA_REFRACTION_" + std::string(name) + ' ' + std::to_string(value) +
               '\n';
    };
    return line("MODEL", static_cast<std::uint32_t>(mImpl->desc.model)) +
           line("BLOCK_BINDING", uniformBufferBinding) + line("TEXTURE_UNIT", textureUnit);
}

void Refraction::bind(std::uint32_t uniformBufferBinding, std::uint32_t textureUnit) {
    if (!mImpl->isReady())
        return;
    mImpl->upload();
    mImpl->bind(uniformBufferBinding, textureUnit);
}

const RefractionDesc& Refraction::desc() const {
    return mImpl->desc;
}

std::uint64_t Refraction::gpuBytes() const {
    return (mImpl->thickness ? mImpl->thickness->gpuBytes() : mImpl->volume->gpuBytes()) +
           mImpl->constants.bytes() + mImpl->report.bytes() + mImpl->target.bytes() +
           mImpl->behind.bytes();
}

} // namespace lamina
