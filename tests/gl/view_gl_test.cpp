// What the GL pipeline draws with an engine's camera is found again by lamina/view.glsl.

#include "gl/binding_guards.hpp"
#include "gl/screen_pass.hpp"
#include "gl/support/gl_state.hpp"
#include "gl/support/gl_test.hpp"
#include "gl/view_constants.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace lamina {
namespace {

constexpr glm::uvec2 kSize{64, 48};
constexpr const char* kPlane = R"(#version 450 core
layout(location = 0) uniform dmat4 worldToClip;
layout(location = 1) uniform dvec3 corner;
layout(location = 2) uniform dvec3 sides[2];
void main() {
    dvec2 at = dvec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(worldToClip * dvec4(corner + sides[0] * at.x + sides[1] * at.y, 1.0lf));
}
)";
constexpr const char* kNothing = "#version 450 core\nvoid main() {}\n";
constexpr const char* kReconstruct = R"(
layout(std140, binding = 0) uniform View { LaminaViewConstants view; };
layout(binding = 0) uniform sampler2D depths;
layout(location = 0) out vec4 world;
layout(location = 1) out vec4 window;
void main() {
    float depth = texelFetch(depths, ivec2(gl_FragCoord.xy), 0).x;
    vec3 point = laminaWorldPoint(view, gl_FragCoord.xy, depth);
    world = vec4(point, laminaIsBackground(view, depth) ? 0.0 : 1.0);
    window = laminaWindowPoint(view, point);
    window.z -= depth;
    window.w = length(laminaTowardsViewer(view, point));
}
)";

/// A triangle that fills part of the view: corner + s a + t b, s, t, s + t in their ranges.
struct Plane {
    glm::dvec3 corner, a, b;
};

struct Case {
    const char* name;
    View view;
    Plane plane;
    glm::dvec3 eye; ///< Or the direction towards the viewer.
    bool isPerspective;
};

std::vector<Case> cases() {
    const glm::dvec3 eye(1000.0, 20.0, -3000.0);
    const glm::dmat4 camera = glm::lookAt(eye, eye + glm::dvec3(1.0, -0.4, 2.0), {0, 1, 0});
    const glm::dvec3 ahead = glm::normalize(glm::dvec3(1.0, -0.4, 2.0));
    const Plane plane{eye + 8.0 * ahead + glm::dvec3(-9, -6, -1), {18, 1, 0}, {1, 14, 4}};
    const double f = 1.0 / std::tan(0.5);
    glm::dmat4 reversedInfinite(0.0);
    reversedInfinite[0][0] = f * 0.75;
    reversedInfinite[1][1] = f;
    reversedInfinite[2][3] = -1.0;
    reversedInfinite[3][2] = 0.1;

    std::vector<Case> all;
    View view;
    view.size = kSize;
    view.worldToClip = glm::perspectiveNO(1.0, 4.0 / 3.0, 0.5, 50.0) * camera;
    all.push_back({"perspective", view, plane, eye, true});
    view.depthRange = {0.75, 0.25};
    view.backgroundDepth = 0.0f;
    all.push_back({"depth range", view, plane, eye, true});
    view.depthRange = {0.0, 1.0};
    view.clipDepth = ClipDepth::ZeroToOne;
    view.worldToClip = reversedInfinite * camera;
    all.push_back({"reversed infinite", view, plane, eye, true});
    view.backgroundDepth = 1.0f;
    view.clipDepth = ClipDepth::NegativeOneToOne;
    view.worldToClip = glm::orthoNO(-8.0, 8.0, -6.0, 6.0, -5.0, 40.0) * camera;
    all.push_back({"orthographic", view, plane, -ahead, false});
    return all;
}

class ViewGlTest : public test::GlTest {
protected:
    gl::Texture texture(GLenum format) {
        gl::Texture made = gl::Texture::create(device().state(), "test", GL_TEXTURE_2D);
        gl().TextureStorage2D(made.id(), 1, format, kSize.x, kSize.y);
        gl().TextureParameteri(made.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        return made;
    }

    /// The plane through the fixed pipeline, as an engine draws it.
    gl::Texture draw(const Case& test) {
        const View& view = test.view;
        gl::Texture depths = texture(GL_DEPTH_COMPONENT32F);
        auto framebuffer = gl::Framebuffer::create(device().state(), "test");
        auto vertexArray = gl::VertexArray::create(device().state(), "test");
        gl().NamedFramebufferTexture(framebuffer.id(), GL_DEPTH_ATTACHMENT, depths.id(), 0);
        gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
        gl().ClearNamedFramebufferfv(framebuffer.id(), GL_DEPTH, 0, &view.backgroundDepth);
        const GLuint program =
            buildProgram({{GL_VERTEX_SHADER, kPlane}, {GL_FRAGMENT_SHADER, kNothing}});
        gl().ProgramUniformMatrix4dv(program, 0, 1, GL_FALSE, &view.worldToClip[0][0]);
        gl().ProgramUniform3dv(program, 1, 1, &test.plane.corner.x);
        const std::array sides{test.plane.a, test.plane.b};
        gl().ProgramUniform3dv(program, 2, 2, &sides[0].x);
        gl().UseProgram(program);
        gl().BindVertexArray(vertexArray.id());
        gl().Viewport(0, 0, kSize.x, kSize.y);
        gl().DepthRange(view.depthRange.x, view.depthRange.y);
        gl().ClipControl(GL_LOWER_LEFT, view.clipDepth == ClipDepth::ZeroToOne
                                            ? GL_ZERO_TO_ONE
                                            : GL_NEGATIVE_ONE_TO_ONE);
        gl().Enable(GL_DEPTH_TEST);
        gl().DepthFunc(GL_ALWAYS);
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        gl().Disable(GL_DEPTH_TEST);
        gl().DepthFunc(GL_LESS);
        gl().DepthRange(0.0, 1.0);
        gl().ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        gl().UseProgram(0);
        gl().BindVertexArray(0);
        gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
        gl().DeleteProgram(program);
        return depths;
    }
};

TEST_F(ViewGlTest, FindsTheWorldPointsThatThePipelineDrew) {
    auto program = gl::findOrBuildProgram(*device().state(),
                                          {"test",
                                           {{GL_VERTEX_SHADER, "gl/screen.vert"},
                                            {GL_FRAGMENT_SHADER, "lamina/view.glsl", kReconstruct}},
                                           {}});
    ASSERT_TRUE(program) << program.error().text;
    gl::ScreenPass pass(device().state(), "test");
    const gl::Texture world = texture(GL_RGBA32F);
    const gl::Texture window = texture(GL_RGBA32F);
    for (const Case& test : cases()) {
        SCOPED_TRACE(test.name);
        const gl::Texture depths = draw(test);
        auto constants = makeViewConstants(test.view, "test");
        ASSERT_TRUE(constants) << constants.error().text;
        const auto block =
            gl::createBuffer(device().state(), sizeof *constants, &*constants, 0, "test", "test");
        ASSERT_TRUE(block);
        gl().BindBufferBase(GL_UNIFORM_BUFFER, 0, block->id());
        gl().BindTextureUnit(0, depths.id());
        const std::array<GLuint, 2> targets{world.id(), window.id()};
        pass.draw(*program, targets, kSize);
        std::vector<glm::vec4> points(kSize.x * kSize.y), windows(points.size());
        const auto bytes = static_cast<GLsizei>(points.size() * sizeof points[0]);
        gl().GetTextureImage(world.id(), 0, GL_RGBA, GL_FLOAT, bytes, points.data());
        gl().GetTextureImage(window.id(), 0, GL_RGBA, GL_FLOAT, bytes, windows.data());
        gl().BindTextureUnit(0, 0);
        gl().BindBufferBase(GL_UNIFORM_BUFFER, 0, 0);

        const glm::dvec3 normal = glm::normalize(glm::cross(test.plane.a, test.plane.b));
        std::size_t seen = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].w == 0.0f)
                continue;
            ++seen;
            const glm::dvec3 point(points[i]);
            // 24-bit mantissas at coordinates of 3000: 2.4e-4; the depth's own rounding adds less.
            EXPECT_NEAR(glm::dot(point - test.plane.corner, normal), 0.0, 2e-3);
            const glm::dvec2 pixel(i % kSize.x + 0.5, i / kSize.x + 0.5);
            const glm::dvec4 clip = test.view.worldToClip * glm::dvec4(point, 1.0);
            const glm::dvec2 drawn = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(kSize);
            EXPECT_NEAR(drawn.x, pixel.x, 2e-2);
            EXPECT_NEAR(drawn.y, pixel.y, 2e-2);
            EXPECT_NEAR(windows[i].x, pixel.x, 2e-2);
            EXPECT_NEAR(windows[i].y, pixel.y, 2e-2);
            EXPECT_NEAR(windows[i].z, 0.0, 1e-4);
            EXPECT_NEAR(windows[i].w, 1.0, 1e-5);
            if (HasFailure())
                return;
        }
        EXPECT_GT(seen, points.size() / 4);
        EXPECT_LT(seen, points.size());
        const glm::dvec4 viewpoint = lamina::viewpoint(test.view).value();
        EXPECT_EQ(viewpoint.w, test.isPerspective ? 1.0 : 0.0);
        EXPECT_LT(glm::distance(glm::dvec3(viewpoint), test.eye), 1e-6);
    }
}

TEST_F(ViewGlTest, ScreenPassLeavesOddStateAsItWas) {
    auto program = gl::findOrBuildProgram(*device().state(),
                                          {"test",
                                           {{GL_VERTEX_SHADER, "gl/screen.vert"},
                                            {GL_FRAGMENT_SHADER, "lamina/view.glsl",
                                             "layout(location = 0) out vec4 color;\nvoid main() { "
                                             "color = vec4(0.25, -2.0, 3.0, 0.5); }\n"}},
                                           {}});
    ASSERT_TRUE(program) << program.error().text;
    gl::ScreenPass pass(device().state(), "test");
    const gl::Texture target = texture(GL_RGBA32F);
    std::vector<glm::vec4> colors(kSize.x * kSize.y, glm::vec4(7.0f));
    {
        const test::OddGlState odd(gl());
        const auto before = test::readGlState(gl());
        const GLuint id = target.id();
        pass.draw(*program, {&id, 1}, kSize);
        EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
    }
    gl().GetTextureImage(target.id(), 0, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(colors.size() * 16), colors.data());
    for (const glm::vec4& color : colors)
        ASSERT_EQ(color, glm::vec4(0.25f, -2.0f, 3.0f, 0.5f));
}

TEST_F(ViewGlTest, GuardsKeepTextureAndImageUnits) {
    const gl::Texture ours = texture(GL_RGBA32F);
    const test::OddGlState odd(gl());
    const auto before = test::readGlState(gl());
    {
        const gl::TextureUnitGuard textures(*device().state(), 0, 4);
        const gl::ImageUnitGuard images(*device().state(), 2);
        for (GLuint unit = 0; unit < 4; ++unit) {
            gl().BindTextureUnit(unit, ours.id());
            gl().BindSampler(unit, 0);
        }
        gl().BindTextureUnit(1, 0);
        gl().BindImageTexture(1, ours.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
        EXPECT_FALSE(test::differences(before, test::readGlState(gl())).empty());
    }
    EXPECT_THAT(test::differences(before, test::readGlState(gl())), testing::IsEmpty());
}

TEST_F(ViewGlTest, RefusesViewsThatCannotBeInverted) {
    View view = cases().front().view;
    EXPECT_TRUE(viewpoint(view));
    view.size.y = 0;
    EXPECT_EQ(viewpoint(view).error().code, ErrorCode::InvalidArgument);
    view = cases().front().view;
    view.worldToClip[2] = glm::dvec4(0.0);
    EXPECT_EQ(viewpoint(view).error().code, ErrorCode::InvalidArgument);
    view.worldToClip[0][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(viewpoint(view).error().code, ErrorCode::InvalidArgument);
    view = cases().front().view;
    view.depthRange = {0.5, 0.5};
    EXPECT_EQ(viewpoint(view).error().code, ErrorCode::InvalidArgument);
}

} // namespace
} // namespace lamina
