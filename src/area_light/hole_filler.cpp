#include "area_light/hole_filler.hpp"

#include "area_light/imperfect_constants.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <algorithm>

namespace lamina {
namespace {

constexpr std::uint32_t kGroup = 8;

} // namespace

HoleFiller::HoleFiller(std::shared_ptr<gl::DeviceState> device)
    : mDevice(std::move(device))
    , mConstants(gl::Buffer::create(mDevice, "lamina fill pass")) {}

Result<HoleFiller> HoleFiller::create(std::shared_ptr<gl::DeviceState> device, std::uint32_t side,
                                      std::uint32_t levels) {
    HoleFiller made(std::move(device));
    made.mLevels.push_back({side, glm::uvec2(0)});
    std::uint32_t row = 0;
    for (std::uint32_t i = 0; i < levels && made.mLevels.back().side > 1; ++i) {
        const std::uint32_t coarser = (made.mLevels.back().side + 1) / 2;
        made.mLevels.push_back({coarser, {side, row}});
        row += coarser;
    }
    const std::pair<const char*, GLuint*> programs[] = {{"0", &made.mPullProgram},
                                                        {"1", &made.mPushProgram}};
    for (const auto& [isPush, program] : programs) {
        const auto built = gl::findOrBuildProgram(
            *made.mDevice, {"lamina hole filling",
                            {{GL_COMPUTE_SHADER, "area_light/fill_holes.comp"}},
                            {{"LAMINA_FILL_PUSH", isPush}}});
        if (!built)
            return built.error();
        *program = *built;
    }
    return made;
}

glm::uvec2 HoleFiller::layerSize() const {
    glm::uvec2 size(0);
    for (const Level& level : mLevels)
        size = glm::max(size, level.first + level.side);
    return size;
}

void HoleFiller::fill(GLuint texture, std::uint32_t maps) const {
    const gl::DebugGroup group(*mDevice, "lamina: fill holes");
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, 0);
    const gl::ImageUnitGuard images(*mDevice, 1);
    gl.BindImageTexture(LAMINA_SPLAT_IMAGE, texture, 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
    const auto run = [&](GLuint program, const Level& level, const Level& other) {
        shared::LaminaSplatConstants constants{};
        constants.level = {0, level.side, level.first};
        constants.other = {other.side, other.first, 0};
        // New storage each time: the last dispatch may still read the old.
        gl.NamedBufferData(mConstants.id(), sizeof constants, &constants, GL_STREAM_DRAW);
        const GLuint uniforms = mConstants.id();
        gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SPLAT_UNIFORM_BINDING, 1, &uniforms);
        gl.UseProgram(program);
        const std::uint32_t groups = (level.side + kGroup - 1) / kGroup;
        gl.DispatchCompute(groups, groups, maps);
        gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    };
    for (std::size_t i = 1; i < mLevels.size(); ++i)
        run(mPullProgram, mLevels[i], mLevels[i - 1]);
    for (std::size_t i = mLevels.size(); i-- > 1;)
        run(mPushProgram, mLevels[i - 1], mLevels[i]);
}

} // namespace lamina
