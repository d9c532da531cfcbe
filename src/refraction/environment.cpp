#include <lamina/refraction/environment.hpp>

#include "core/check_enumeration.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "refraction/receiver_textures.hpp"
#include "refraction/seamless_cube_maps.hpp"

#include <algorithm>
#include <bit>
#include <string>

namespace lamina {
namespace {

constexpr std::string_view kOperation = "environment";
constexpr GLuint kGroup = 8;

Result<GLuint> computeProgram(gl::DeviceState& device, const char* shader,
                              std::vector<gl::ShaderDefine> defines = {}) {
    return gl::findOrBuildProgram(
        device, {"lamina environment", {{GL_COMPUTE_SHADER, shader}}, std::move(defines)});
}

} // namespace

struct Environment::Impl {
    std::shared_ptr<gl::DeviceState> device;
    EnvironmentDesc desc;
    gl::Texture cube;
    GLuint loadCube = 0, loadFlat = 0, filter = 0;

    [[nodiscard]] std::uint32_t levels() const {
        return static_cast<std::uint32_t>(std::bit_width(desc.size));
    }
    [[nodiscard]] Result<void> load(std::uint32_t source, GLenum target, GLuint program);
    void dispatch(std::uint32_t level);
};

void Environment::Impl::dispatch(std::uint32_t level) {
    constexpr GLuint kFaces = 6;
    const GladGLContext& gl = device->gl;
    gl.BindImageTexture(0, cube.id(), static_cast<GLint>(level), GL_TRUE, 0, GL_WRITE_ONLY,
                        GL_RGBA16F);
    const GLuint groups = (std::max(desc.size >> level, 1u) + kGroup - 1) / kGroup;
    gl.DispatchCompute(groups, groups, kFaces);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

Result<void> Environment::Impl::load(std::uint32_t source, GLenum target, GLuint program) {
    const GladGLContext& gl = device->gl;
    if (auto fits = checkEnvironmentTexture(device, source, target); !fits)
        return fits;
    const gl::DebugGroup group(*device, "lamina: load environment");
    const gl::ComputeStateGuard compute(*device, 0, 0);
    const gl::TextureUnitGuard textures(*device, 0, 1);
    const gl::ImageUnitGuard images(*device, 1);
    const SeamlessCubeMaps seamless(gl);
    gl.BindTextureUnit(0, source);
    gl.BindSampler(0, 0);
    gl.UseProgram(program);
    dispatch(0);
    if (desc.filter == EnvironmentFilter::MipPyramid) {
        gl.GenerateTextureMipmap(cube.id());
        return {};
    }
    gl.UseProgram(filter);
    gl.BindTextureUnit(0, cube.id());
    for (std::uint32_t level = 1; level < levels(); ++level) {
        // Look-ups see the level above as their level 0. Mesa stores nothing to a level outside the
        // texture's range.
        const auto above = static_cast<GLint>(level) - 1;
        gl.TextureParameteri(cube.id(), GL_TEXTURE_BASE_LEVEL, above);
        gl.TextureParameteri(cube.id(), GL_TEXTURE_MAX_LEVEL, above + 1);
        dispatch(level);
    }
    gl.TextureParameteri(cube.id(), GL_TEXTURE_BASE_LEVEL, 0);
    gl.TextureParameteri(cube.id(), GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(levels()) - 1);
    return {};
}

Environment::Environment(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
Environment::Environment(Environment&&) noexcept = default;
Environment& Environment::operator=(Environment&&) noexcept = default;
Environment::~Environment() = default;

Result<Environment> Environment::create(const Device& device, const EnvironmentDesc& desc) {
    if (auto known = checkEnumeration(kOperation, "EnvironmentFilter", desc.filter,
                                      EnvironmentFilter::Gaussian);
        !known)
        return known.error();
    if (!std::has_single_bit(desc.size))
        return Error{ErrorCode::InvalidArgument,
                     "environment: expected a power of two of texels a side, found " +
                         std::to_string(desc.size)};
    auto impl = std::make_unique<Impl>();
    impl->device = device.state();
    impl->desc = desc;
    auto cube = gl::createMippedCubeMap(impl->device, GL_RGBA16F, 8, desc.size, kOperation,
                                        "lamina environment");
    if (!cube)
        return cube.error();
    impl->cube = std::move(*cube);
    for (std::uint32_t level = 0; level < impl->levels(); ++level)
        impl->device->gl.ClearTexImage(impl->cube.id(), static_cast<GLint>(level), GL_RGBA,
                                       GL_FLOAT, nullptr);
    struct Part {
        GLuint& program;
        const char* shader;
        std::vector<gl::ShaderDefine> defines;
    };
    const Part parts[] = {
        {impl->loadCube,
         "refraction/environment_load.comp",
         {{"LAMINA_ENVIRONMENT_EQUIRECTANGULAR", "0"}}},
        {impl->loadFlat,
         "refraction/environment_load.comp",
         {{"LAMINA_ENVIRONMENT_EQUIRECTANGULAR", "1"}}},
        {impl->filter, "refraction/environment_filter.comp", {}},
    };
    for (const Part& part : parts) {
        auto program = computeProgram(*impl->device, part.shader, part.defines);
        if (!program)
            return program.error();
        part.program = *program;
    }
    return Environment(std::move(impl));
}

Result<void> Environment::loadCubeMap(std::uint32_t texture) {
    return mImpl->load(texture, GL_TEXTURE_CUBE_MAP, mImpl->loadCube);
}

Result<void> Environment::loadEquirectangular(std::uint32_t texture) {
    return mImpl->load(texture, GL_TEXTURE_2D, mImpl->loadFlat);
}

std::uint32_t Environment::texture() const {
    return mImpl->cube.id();
}

const EnvironmentDesc& Environment::desc() const {
    return mImpl->desc;
}

std::uint32_t Environment::levels() const {
    return mImpl->levels();
}

std::uint64_t Environment::gpuBytes() const {
    return mImpl->cube.bytes();
}

} // namespace lamina
