#include "area_light/light_gather.hpp"

#include "area_light/area_light_constants.hpp"
#include "gl/binding_guards.hpp"
#include "gl/host_texture.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "gl/view_constants.hpp"

#include <algorithm>
#include <string>
#include <string_view>

namespace lamina {
namespace {

constexpr const char* kOperation = "area light apply";
/// Relative difference of distances between which the filters fade.
constexpr float kDistanceLikeness = 0.05f;

int filterOf(GatherMode mode) {
    switch (mode) {
    case GatherMode::Full:
        return LAMINA_AREA_LIGHT_FILTER_NONE;
    case GatherMode::Interleaved:
        return LAMINA_AREA_LIGHT_FILTER_INTERLEAVED;
    case GatherMode::Quarter:
        break;
    }
    return LAMINA_AREA_LIGHT_FILTER_UPSAMPLE;
}

/// The program cache calls all GLSL of hosts a vertex stage.
Error namingReflectance(Error error) {
    constexpr std::string_view kStage = "host vertex stage";
    constexpr std::string_view kReflectance = "surfaceReflectance";
    for (const std::string& called : {"the " + std::string(kStage), std::string(kStage)})
        for (std::size_t at = 0; (at = error.text.find(called, at)) != std::string::npos;)
            error.text.replace(at, called.size(), kReflectance);
    return error;
}

template<class Block>
void stream(const gl::DeviceState& device, const gl::Buffer& buffer, const Block& block) {
    // New storage each time: passes of the last call may still read the old.
    device.gl.NamedBufferData(buffer.id(), sizeof block, &block, GL_STREAM_DRAW);
}

} // namespace

LightGather::LightGather(std::shared_ptr<gl::DeviceState> device, const AreaLightDesc& desc)
    : mDevice(std::move(device))
    , mDesc(desc)
    , mScreen(mDevice, "lamina area light")
    , mProbe(gl::Framebuffer::create(mDevice, "lamina area light probe"))
    , mSampler(mDevice)
    , mView(gl::Buffer::create(mDevice, "lamina area light view"))
    , mConstants(gl::Buffer::create(mDevice, "lamina area light gather")) {}

Result<std::unique_ptr<LightGather>> LightGather::create(std::shared_ptr<gl::DeviceState> device,
                                                         const AreaLightDesc& desc) {
    const bool hasHostSource = !desc.surfaceReflectance.empty();
    const auto gather = gl::findOrBuildProgram(
        *device, {"lamina area light gather",
                  {{GL_COMPUTE_SHADER,
                    hasHostSource ? "area_light/gather_main.glsl" : "area_light/gather.comp",
                    desc.surfaceReflectance}},
                  {}});
    if (!gather)
        return hasHostSource ? namingReflectance(gather.error()) : gather.error();
    const auto composite = gl::findOrBuildProgram(
        *device,
        {"lamina area light composite",
         {{GL_VERTEX_SHADER, "gl/screen.vert"}, {GL_FRAGMENT_SHADER, "area_light/composite.frag"}},
         {{"LAMINA_AREA_LIGHT_FILTER", std::to_string(filterOf(desc.gather))}}});
    if (!composite)
        return composite.error();
    std::unique_ptr<LightGather> made(new LightGather(std::move(device), desc));
    made->mGatherProgram = *gather;
    made->mCompositeProgram = *composite;
    return made;
}

glm::uvec2 LightGather::sumsSize(const glm::uvec2& view) const {
    return mDesc.gather == GatherMode::Quarter ? (view + 1u) / 2u : view;
}

Result<void> LightGather::reserve(const glm::uvec2& view, bool needsPicture) {
    const glm::uvec2 size = sumsSize(view);
    if (size != mSumsSize) {
        std::array<gl::Texture, 2> made;
        for (gl::Texture& texture : made) {
            auto created = gl::createTexture2d(mDevice, GL_RGBA32F, 16, size.x, size.y, kOperation,
                                               "lamina area light sums");
            if (!created)
                return created.error();
            texture = std::move(*created);
        }
        mSums = std::move(made);
        mSumsSize = size;
    }
    if (needsPicture && view != mPictureSize) {
        auto created = gl::createTexture2d(mDevice, GL_RGBA16F, 8, view.x, view.y, kOperation,
                                           "lamina area light picture");
        if (!created)
            return created.error();
        mPicture = std::move(*created);
        mPictureSize = view;
    }
    return {};
}

Result<void> LightGather::checkTexture(GLuint texture, const glm::uvec2& view, const char* what,
                                       bool isDrawnTo) const {
    const GladGLContext& gl = mDevice->gl;
    GLint target = 0;
    glm::ivec2 size(0);
    if (gl.IsTexture(texture))
        gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
    const bool is2d = target == GL_TEXTURE_2D;
    const auto level = [&](GLenum name) {
        GLint value = 0;
        gl.GetTextureLevelParameteriv(texture, 0, name, &value);
        return value;
    };
    if (is2d)
        size = {level(GL_TEXTURE_WIDTH), level(GL_TEXTURE_HEIGHT)};
    const auto error = [&](const std::string& expected, const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     std::string(kOperation) + ": expected a 2D texture " + expected + " as " +
                         what + ", found " + found + " as texture " + std::to_string(texture)};
    };
    if (!is2d || glm::uvec2(size) != view)
        return error("of " + std::to_string(view.x) + " x " + std::to_string(view.y) + " texels",
                     is2d ? std::to_string(size.x) + " x " + std::to_string(size.y) : "none");
    const GLint type = level(GL_TEXTURE_RED_TYPE);
    if (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED && type != GL_SIGNED_NORMALIZED)
        return error("of a float or normalized colour format", "another format");
    if (!isDrawnTo)
        return {};
    // Mesa (22.3) says of every format that it is renderable (GL_FRAMEBUFFER_RENDERABLE).
    gl.NamedFramebufferTexture(mProbe.id(), GL_COLOR_ATTACHMENT0, texture, 0);
    const GLenum status = gl.CheckNamedFramebufferStatus(mProbe.id(), GL_DRAW_FRAMEBUFFER);
    gl.NamedFramebufferTexture(mProbe.id(), GL_COLOR_ATTACHMENT0, 0, 0);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        return error("of a colour-renderable format", "another format");
    return {};
}

Result<void> LightGather::check(const Frame& frame, GLuint target) const {
    const SurfaceTextures& surfaces = frame.surfaces;
    if (auto step = gl::depthStep(*mDevice, surfaces.depth, frame.view.size, kOperation); !step)
        return step.error();
    const std::pair<const char*, GLuint> others[] = {
        {"normal", surfaces.normal}, {"albedo", surfaces.albedo}, {"color", surfaces.color}};
    for (const auto& [what, texture] : others)
        if (texture != 0)
            if (auto sound = checkTexture(texture, frame.view.size, what, false); !sound)
                return sound;
    const GLuint drawn = target != 0 ? target : mPicture.id();
    for (const GLuint read : {surfaces.depth, surfaces.normal, surfaces.albedo, surfaces.color})
        if (read != 0 && read == drawn)
            return Error{ErrorCode::InvalidArgument,
                         std::string(kOperation) +
                             ": expected a target that is none of the surfaces' textures, found "
                             "texture " +
                             std::to_string(drawn) + " as both; copy it first"};
    if (target == 0)
        return {};
    return checkTexture(target, frame.view.size, "target", true);
}

Result<GLuint> LightGather::run(const Frame& frame, GLuint target, StageTimers& timers) {
    const gl::DebugGroup group(*mDevice, "lamina: area light");
    const auto view = makeViewConstants(frame.view, kOperation);
    if (!view)
        return view.error();
    if (auto sound = check(frame, target); !sound)
        return sound.error();
    if (auto room = reserve(frame.view.size, target == 0); !room)
        return room.error();
    stream(*mDevice, mView, *view);
    {
        const StageTimers::Scope scope(timers, AreaLightStage::Gather);
        gather(frame);
    }
    const StageTimers::Scope scope(timers, AreaLightStage::Composite);
    const GLuint result = target != 0 ? target : mPicture.id();
    composite(frame, result);
    return result;
}

void LightGather::setConstants(const Frame& frame, const glm::uvec4& lights, bool adds) {
    shared::LaminaGatherConstants block{};
    block.lights = lights;
    const SurfaceTextures& surfaces = frame.surfaces;
    std::uint32_t flags = adds ? LAMINA_AREA_LIGHT_ADDS : 0u;
    flags |= surfaces.normal != 0 ? LAMINA_AREA_LIGHT_HAS_NORMALS : 0u;
    flags |= surfaces.albedo != 0 ? LAMINA_AREA_LIGHT_HAS_ALBEDO : 0u;
    flags |= surfaces.color != 0 ? LAMINA_AREA_LIGHT_HAS_COLOR : 0u;
    flags |= surfaces.unsignedNormals ? LAMINA_AREA_LIGHT_UNSIGNED_NORMALS : 0u;
    block.pixels = {mSumsSize, mDesc.gather == GatherMode::Quarter ? 2 : 1, flags};
    block.numbers = {static_cast<float>(frame.skyDistance), kDistanceLikeness,
                     mDesc.specularExponent, mDesc.specularStrength};
    stream(*mDevice, mConstants, block);
    const GLuint buffers[] = {mView.id(), mConstants.id()};
    mDevice->gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_AREA_LIGHT_PASS_VIEW_BINDING, 2, buffers);
}

void LightGather::bindInputs(const Frame& frame, bool isComposite) const {
    const GladGLContext& gl = mDevice->gl;
    std::vector<std::pair<GLuint, GLuint>> units = {
        {LAMINA_AREA_LIGHT_PASS_DEPTH_UNIT, frame.surfaces.depth},
        {LAMINA_AREA_LIGHT_PASS_NORMAL_UNIT, frame.surfaces.normal}};
    if (isComposite)
        units.insert(units.end(), {{LAMINA_AREA_LIGHT_PASS_ALBEDO_UNIT, frame.surfaces.albedo},
                                   {LAMINA_AREA_LIGHT_PASS_COLOR_UNIT, frame.surfaces.color},
                                   {LAMINA_AREA_LIGHT_PASS_AIRLIGHT_UNIT, mSums[0].id()},
                                   {LAMINA_AREA_LIGHT_PASS_SURFACE_UNIT, mSums[1].id()}});
    for (const auto& [unit, texture] : units) {
        gl.BindTextureUnit(unit, texture);
        gl.BindSampler(unit, mSampler.id());
    }
}

void LightGather::gather(const Frame& frame) {
    const gl::DebugGroup group(*mDevice, "lamina: gather lights");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 2, 2);
    const gl::TextureUnitGuard textures(*mDevice, 0, LAMINA_AREA_LIGHT_PASS_UNITS);
    const gl::ImageUnitGuard images(*mDevice, 2);
    bindInputs(frame, false);
    for (GLuint i = 0; i < 2; ++i)
        gl.BindImageTexture(LAMINA_AREA_LIGHT_PASS_AIRLIGHT_IMAGE + i, mSums[i].id(), 0, GL_FALSE,
                            0, GL_READ_WRITE, GL_RGBA32F);
    const GLuint lights = frame.lights;
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_AREA_LIGHT_PASS_LIGHT_BINDING, 1, &lights);
    gl.UseProgram(mGatherProgram);

    constexpr std::uint32_t kSubsets = 9;
    // A view without a whole block of pixels, or a subset without a light, would lose light.
    const bool isInterleaved = mDesc.gather == GatherMode::Interleaved &&
                               frame.volumes.size() == 1 && frame.lightCount >= kSubsets &&
                               mSumsSize.x >= 3 && mSumsSize.y >= 3;
    const std::uint32_t subsets = isInterleaved ? kSubsets : 1;
    const std::uint32_t block = LAMINA_AREA_LIGHT_GATHER_SIZE * (isInterleaved ? 3 : 1);
    const glm::uvec2 groups = (mSumsSize + (block - 1)) / block;
    const auto lightsPerGrid = frame.lightCount / static_cast<std::uint32_t>(frame.volumes.size());
    for (std::uint32_t i = 0; i < frame.volumes.size(); ++i) {
        frame.volumes[i].bind(LAMINA_AREA_LIGHT_PASS_SPACE_BINDING,
                              LAMINA_AREA_LIGHT_PASS_WORD_UNIT);
        setConstants(frame, {i * lightsPerGrid, lightsPerGrid, 0, subsets}, i > 0);
        gl.DispatchCompute(groups.x, groups.y, subsets);
        gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void LightGather::composite(const Frame& frame, GLuint target) {
    const gl::DebugGroup group(*mDevice, "lamina: composite lights");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 2, 2);
    const gl::TextureUnitGuard textures(*mDevice, 0, LAMINA_AREA_LIGHT_PASS_UNITS);
    bindInputs(frame, true);
    const GLuint lights = frame.lights;
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_AREA_LIGHT_PASS_LIGHT_BINDING, 1, &lights);
    setConstants(frame, {0, frame.lightCount, 0, 1}, false);
    mScreen.draw(mCompositeProgram, {&target, 1}, frame.view.size);
}

} // namespace lamina
