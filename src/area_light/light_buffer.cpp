#include "area_light/light_buffer.hpp"

#include "area_light/area_light_constants.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <glm/geometric.hpp>

#include <cstring>
#include <vector>

namespace lamina {
namespace {

shared::LaminaVirtualLight makeLight(const VirtualLight& light) {
    const bool isDirectional = light.light.kind == LightKind::Directional;
    shared::LaminaVirtualLight block{};
    block.position = isDirectional
                         ? glm::vec4(-glm::vec3(glm::normalize(light.light.direction)), 0.0f)
                         : glm::vec4(glm::vec3(light.light.position), 1.0f);
    block.normal = glm::vec4(glm::vec3(light.normal), static_cast<float>(light.radius));
    block.intensity = glm::vec4(light.intensity, light.isLambertian() ? 1.0f : 0.0f);
    return block;
}

} // namespace

LightBuffer::LightBuffer(std::shared_ptr<gl::DeviceState> device, GLuint tintProgram)
    : mDevice(std::move(device))
    , mTintProgram(tintProgram)
    , mLights(gl::Buffer::create(mDevice, "lamina virtual lights"))
    , mPlaces(gl::Buffer::create(mDevice, "lamina virtual light places")) {}

Result<LightBuffer> LightBuffer::create(std::shared_ptr<gl::DeviceState> device) {
    const auto program = gl::findOrBuildProgram(
        *device, {"lamina area light tint", {{GL_COMPUTE_SHADER, "area_light/tint.comp"}}, {}});
    if (!program)
        return program.error();
    return LightBuffer(std::move(device), *program);
}

Result<void> LightBuffer::check(GLuint texture) const {
    if (texture == 0)
        return {};
    const GladGLContext& gl = mDevice->gl;
    GLint target = 0;
    GLint width = 0;
    if (gl.IsTexture(texture)) {
        gl.GetTextureParameteriv(texture, GL_TEXTURE_TARGET, &target);
        if (target == GL_TEXTURE_2D)
            gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
    }
    if (width == 0)
        return Error{ErrorCode::InvalidArgument,
                     "area light: expected a 2D texture with storage as the light's emission, "
                     "found texture " +
                         std::to_string(texture)};
    GLint type = 0;
    gl.GetTextureLevelParameteriv(texture, 0, GL_TEXTURE_RED_TYPE, &type);
    if (type != GL_FLOAT && type != GL_UNSIGNED_NORMALIZED && type != GL_SIGNED_NORMALIZED)
        return Error{ErrorCode::InvalidArgument,
                     "area light: expected a texture of a float or normalized colour format as the "
                     "light's emission, found another format as texture " +
                         std::to_string(texture)};
    return {};
}

void LightBuffer::upload(std::span<const VirtualLight> lights, const Medium& medium,
                         const AreaLightDesc& desc, GLuint texture) {
    shared::LaminaAreaLightConstants head{};
    head.medium = glm::vec4(medium.albedo * medium.extinction, medium.extinction);
    head.phase = {medium.anisotropy, 0.0f, 0.0f, 0.0f};
    head.counts.x = static_cast<std::uint32_t>(lights.size());
    if (desc.interpolate)
        head.counts.y |= LAMINA_AREA_LIGHT_INTERPOLATE;
    if (desc.airlight == AirlightForm::Factored)
        head.counts.y |= LAMINA_AREA_LIGHT_FACTORED;
    std::vector<shared::LaminaVirtualLight> blocks;
    for (const VirtualLight& light : lights)
        blocks.push_back(makeLight(light));
    std::vector<std::byte> bytes(sizeof head + blocks.size() * sizeof blocks[0]);
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, blocks.data(), blocks.size() * sizeof blocks[0]);
    // New storage each time: dispatches of the last frame may still read the old.
    mDevice->gl.NamedBufferData(mLights.id(), static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                                GL_STREAM_DRAW);
    if (texture != 0)
        tint(lights, texture);
}

void LightBuffer::tint(std::span<const VirtualLight> lights, GLuint texture) {
    const gl::DebugGroup group(*mDevice, "lamina: tint virtual lights");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 0, 2);
    const gl::TextureUnitGuard textures(*mDevice, 0, 1);
    std::vector<glm::vec4> places;
    for (const VirtualLight& light : lights)
        places.emplace_back(light.textureCoordinates, light.textureShare, 0.0f);
    gl.NamedBufferData(mPlaces.id(), static_cast<GLsizeiptr>(places.size() * sizeof places[0]),
                       places.data(), GL_STREAM_DRAW);
    const GLuint buffers[] = {mLights.id(), mPlaces.id()};
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 2, buffers);
    gl.BindTextureUnit(0, texture);
    gl.BindSampler(0, 0);
    gl.UseProgram(mTintProgram);
    gl.DispatchCompute((static_cast<GLuint>(lights.size()) + 63) / 64, 1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

} // namespace lamina
