#include "gl/support/gl_test.hpp"

#include "gl/support/gl_state.hpp"

#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace lamina::test {
namespace {

std::optional<headless::Context> gContext;
std::vector<std::string> gHighSeverity;

void GLAD_API_PTR onDebugMessage(GLenum, GLenum, GLuint, GLenum severity, GLsizei length,
                                 const GLchar* message, const void*) {
    if (severity == GL_DEBUG_SEVERITY_HIGH)
        gHighSeverity.emplace_back(message, static_cast<std::size_t>(length));
}

} // namespace

headless::Context& context() {
    return *gContext;
}

std::vector<std::string> GlTest::takeHighSeverityMessages() {
    return std::exchange(gHighSeverity, {});
}

void GlTest::SetUp() {
    DeviceDesc desc;
    if (const char* shaders = std::getenv("LAMINA_SHADER_DIR"))
        desc.shaderOverrideDirectory = shaders;
    auto created = Device::fromCurrentContext(
        [](const char* name) { return context().getProcAddress(name); }, desc);
    ASSERT_TRUE(created) << created.error().text;
    mDevice.emplace(std::move(*created));
    gl().Enable(GL_DEBUG_OUTPUT);
    gl().Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl().DebugMessageCallback(onDebugMessage, nullptr);
}

void GlTest::TearDown() {
    if (!mDevice)
        return;
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR));
    for (const std::string& message : takeHighSeverityMessages())
        ADD_FAILURE() << "high-severity GL message: " << message;
    gl().DeleteBuffers(static_cast<GLsizei>(mHostBuffers.size()), mHostBuffers.data());
    mHostBuffers.clear();
    mDevice.reset();
}

GLuint GlTest::hostBuffer(std::span<const std::byte> bytes) {
    GLuint id = 0;
    gl().CreateBuffers(1, &id);
    gl().NamedBufferData(id, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
    mHostBuffers.push_back(id);
    return id;
}

void GlTest::expectUnchanged(const char* what, const std::function<void()>& call) {
    const GlState before = readGlState(gl());
    call();
    EXPECT_THAT(differences(before, readGlState(gl())), testing::IsEmpty()) << what;
    EXPECT_EQ(gl().GetError(), static_cast<GLenum>(GL_NO_ERROR)) << what;
}

GLuint GlTest::buildProgram(std::vector<std::pair<GLenum, std::string>> stages) {
    const GLuint program = gl().CreateProgram();
    for (const auto& [stage, source] : stages) {
        const GLuint shader = gl().CreateShader(stage);
        const char* text = source.c_str();
        gl().ShaderSource(shader, 1, &text, nullptr);
        gl().CompileShader(shader);
        GLint compiled = GL_FALSE;
        gl().GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
        if (compiled != GL_TRUE) {
            char log[4096] = {};
            gl().GetShaderInfoLog(shader, sizeof log, nullptr, log);
            ADD_FAILURE() << log;
        }
        gl().AttachShader(program, shader);
        gl().DeleteShader(shader);
    }
    gl().LinkProgram(program);
    GLint linked = GL_FALSE;
    gl().GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        char log[4096] = {};
        gl().GetProgramInfoLog(program, sizeof log, nullptr, log);
        ADD_FAILURE() << log;
    }
    return program;
}

void GlTest::runCompute(GLuint program, std::span<const std::byte> input,
                        std::span<std::byte> output, std::uint32_t invocations) {
    GLuint buffers[2];
    gl().CreateBuffers(2, buffers);
    gl().NamedBufferData(buffers[0], static_cast<GLsizeiptr>(input.size()), input.data(),
                         GL_STATIC_DRAW);
    gl().NamedBufferData(buffers[1], static_cast<GLsizeiptr>(output.size()), nullptr,
                         GL_DYNAMIC_READ);
    gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
    gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
    gl().UseProgram(program);
    gl().DispatchCompute((invocations + 63) / 64, 1, 1);
    gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl().GetNamedBufferSubData(buffers[1], 0, static_cast<GLsizeiptr>(output.size()),
                               output.data());
    gl().UseProgram(0);
    gl().DeleteBuffers(2, buffers);
}

/// `--context=egl` or `--context=osmesa`. A promised context that is missing fails the run.
int runAll(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    headless::ContextDesc desc;
    desc.debug = true;
    const std::string choice = argc == 2 ? argv[1] : "";
    if (choice == "--context=egl") {
        desc.api = headless::ContextApi::Egl;
    } else if (choice == "--context=osmesa") {
        desc.api = headless::ContextApi::OsMesa;
    } else {
        std::fprintf(stderr, "usage: %s --context=egl|osmesa\n", argv[0]);
        return 2;
    }
    auto created = headless::Context::create(desc);
    if (!created) {
        std::fprintf(stderr, "%s\n", created.error().text.c_str());
        return 1;
    }
    gContext.emplace(std::move(*created));
    std::printf("context: %s\n", gContext->describe().c_str());
    const int failed = RUN_ALL_TESTS();
    gContext.reset();
    return failed;
}

} // namespace lamina::test

int main(int argc, char** argv) {
    return lamina::test::runAll(argc, argv);
}
