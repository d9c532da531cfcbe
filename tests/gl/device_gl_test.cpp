// The GL floor: devices, handles, programs.

#include "gl/program_cache.hpp"
#include "gl/support/gl_test.hpp"
#include "support/temporary_folder.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/shapes.hpp>

#include <gmock/gmock.h>

#include <filesystem>

namespace lamina {
namespace {

using testing::AllOf;
using testing::HasSubstr;

void* load(const char* name) {
    return test::context().getProcAddress(name);
}

class DeviceGlTest : public test::GlTest {};

TEST_F(DeviceGlTest, ReportsTheImplementation) {
    const DeviceInfo& info = device().info();
    EXPECT_EQ(info.renderer, reinterpret_cast<const char*>(gl().GetString(GL_RENDERER)));
    EXPECT_GE(info.majorVersion * 10 + info.minorVersion, 45);
    EXPECT_EQ(info.isSoftware, info.renderer.find("llvmpipe") != std::string::npos ||
                                   info.renderer.find("softpipe") != std::string::npos);
    const DeviceLimits& limits = device().limits();
    EXPECT_GE(limits.maxTextureSize, 16384u); // the least values that GL 4.5 allows
    EXPECT_GE(limits.maxArrayTextureLayers, 2048u);
    EXPECT_GE(limits.maxDrawBuffers, 8u);
    EXPECT_GE(limits.maxVertexAttribStride, 2048u);
    EXPECT_GE(limits.subpixelBits, 4u);
}

TEST_F(DeviceGlTest, NoContextIsAnError) {
    // A loader that knows the functions, but no context current: as eglGetProcAddress behaves.
    const auto none = Device::fromCurrentContext([](const char*) -> void* { return nullptr; });
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().code, ErrorCode::NoContext);
    EXPECT_THAT(none.error().text, HasSubstr("expected a GL context current"));
}

TEST_F(DeviceGlTest, AContextOlderThan45IsAnError) {
    // The host's loader, with the answers of an old driver.
    static const auto kOldString = +[](GLenum name) -> const GLubyte* {
        return reinterpret_cast<const GLubyte*>(name == GL_VERSION ? "3.3 (Core Profile) Old"
                                                                   : "Old");
    };
    const auto oldLoader = [](const char* name) -> void* {
        return std::string_view(name) == "glGetString" ? reinterpret_cast<void*>(kOldString)
                                                       : load(name);
    };
    const auto old = Device::fromCurrentContext(oldLoader);
    ASSERT_FALSE(old);
    EXPECT_EQ(old.error().code, ErrorCode::UnsupportedDevice);
    EXPECT_THAT(old.error().text,
                AllOf(HasSubstr("expected OpenGL 4.5 or newer"), HasSubstr("found 3.3")));
}

TEST_F(DeviceGlTest, ARealContextOlderThan45IsAnError) {
    headless::ContextDesc desc;
    desc.majorVersion = 3;
    desc.minorVersion = 3;
    auto old = headless::Context::create(desc);
    if (old) {
        const auto result =
            Device::fromCurrentContext([&](const char* name) { return old->getProcAddress(name); });
        // Drivers may give a newer context than was asked for.
        if (!result) {
            EXPECT_EQ(result.error().code, ErrorCode::UnsupportedDevice);
            EXPECT_THAT(result.error().text, HasSubstr("4.5"));
        }
    }
    old = Error{};
    ASSERT_TRUE(test::context().makeCurrent());
}

TEST_F(DeviceGlTest, SeveralDevicesLiveSideBySide) {
    auto other = headless::Context::create({});
    ASSERT_TRUE(other) << other.error().text;
    {
        auto second = Device::fromCurrentContext(
            [&](const char* name) { return other->getProcAddress(name); });
        ASSERT_TRUE(second) << second.error().text;
        const TriangleMesh mesh = reference::makeIcosphere({0, 0, 0}, 1.0f, 2);
        const GridTransform transform = GridTransform::box(mesh.bounds(), {20, 20, 20}).value();
        const auto voxelize = [&](Device& on) {
            auto buffers = MeshBuffers::upload(on, mesh).value();
            auto voxelizer = Voxelizer::create(on).value();
            auto grid = VoxelGrid::create(on).value();
            const GeometrySource source = buffers.view();
            EXPECT_TRUE(voxelizer->voxelize({&source, 1}, transform, grid));
            return grid.download().value();
        };
        const BitGrid there = voxelize(*second);
        ASSERT_TRUE(test::context().makeCurrent());
        EXPECT_TRUE(compare(voxelize(device()), there)->equal());
        ASSERT_TRUE(other->makeCurrent());
    }
    other = Error{};
    ASSERT_TRUE(test::context().makeCurrent());
}

TEST_F(DeviceGlTest, HandlesOwnBorrowAndRelease) {
    const auto& state = device().state();
    GLuint id = 0;
    {
        const gl::Buffer buffer = gl::Buffer::create(state, "owned");
        id = buffer.id();
        EXPECT_TRUE(gl().IsBuffer(id));
        char label[16] = {};
        gl().GetObjectLabel(GL_BUFFER, id, sizeof label, nullptr, label);
        EXPECT_STREQ(label, "owned");
    }
    EXPECT_FALSE(gl().IsBuffer(id));

    gl::Texture texture = gl::Texture::create(state, "texture", GL_TEXTURE_2D);
    { const auto borrowed = gl::Texture::wrap(state, texture.id(), gl::Ownership::Borrowed); }
    EXPECT_TRUE(gl().IsTexture(texture.id()));
    gl::Texture moved = std::move(texture);
    EXPECT_FALSE(texture); // NOLINT: a moved-from handle holds nothing
    id = moved.release();
    EXPECT_TRUE(gl().IsTexture(id));
    { const auto owned = gl::Texture::wrap(state, id, gl::Ownership::Owned); }
    EXPECT_FALSE(gl().IsTexture(id));
    EXPECT_EQ(gl::Buffer().id(), 0u);
}

TEST_F(DeviceGlTest, ProgramsAreBuiltOnce) {
    const gl::ProgramDesc desc{"test",
                               {{GL_VERTEX_SHADER, "voxelize/mesh.vert"},
                                {GL_GEOMETRY_SHADER, "voxelize/slicemap.geom"},
                                {GL_FRAGMENT_SHADER, "voxelize/slicemap.frag"}},
                               {{"LAMINA_COVERAGE", "LAMINA_COVERAGE_SAMPLED"}}};
    const GLuint first = gl::findOrBuildProgram(*device().state(), desc).value();
    EXPECT_EQ(gl::findOrBuildProgram(*device().state(), desc).value(), first);
    gl::ProgramDesc filled = desc;
    filled.defines[0].value = "LAMINA_COVERAGE_FILLED";
    EXPECT_NE(gl::findOrBuildProgram(*device().state(), filled).value(), first);
    gl::ProgramDesc missing = desc;
    missing.stages[0].shader = "voxelize/none.vert";
    EXPECT_EQ(gl::findOrBuildProgram(*device().state(), missing).error().code, ErrorCode::NotFound);
}

TEST_F(DeviceGlTest, AnOverrideDirectoryReplacesShaders) {
    const test::TemporaryFolder root;
    std::filesystem::create_directories(root / "voxelize");
    test::writeBytes(root / "voxelize/slicemap.frag", "void main() { broken }\n");
    std::vector<std::string> messages;
    {
        auto overridden = Device::fromCurrentContext(
            load, {.shaderOverrideDirectory = root.path(), .message = [&](const Message& message) {
                       messages.emplace_back(message.text);
                   }});
        ASSERT_TRUE(overridden);
        const auto voxelizer = Voxelizer::create(*overridden);
        ASSERT_FALSE(voxelizer);
        EXPECT_EQ(voxelizer.error().code, ErrorCode::ShaderError);
        EXPECT_THAT(voxelizer.error().text, HasSubstr("voxelize/slicemap.frag:1"));
        EXPECT_THAT(takeHighSeverityMessages(), testing::Not(testing::IsEmpty())); // the compiler's
        std::filesystem::remove_all(root.path());
        EXPECT_TRUE(Voxelizer::create(*overridden));
    }
    EXPECT_THAT(messages, testing::Contains(HasSubstr("slicemap serves sampled coverage")));
}

TEST_F(DeviceGlTest, ShadersForHosts) {
    EXPECT_THAT(shaderSource("lamina/grid.glsl").value(), HasSubstr("laminaPointCountNearer"));
    EXPECT_EQ(shaderSource("lamina/none.glsl").error().code, ErrorCode::NotFound);
}

} // namespace
} // namespace lamina
