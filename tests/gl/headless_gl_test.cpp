// Contexts of both kinds. A kind that this machine promises and does not give fails the run.

#include <lamina/headless/context.hpp>

#include "gl/shader_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <dlfcn.h>

#include <array>
#include <thread>
#include <utility>
#include <vector>

namespace lamina::headless {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr unsigned kMajorVersion = 0x821B;
constexpr unsigned kMinorVersion = 0x821C;
constexpr unsigned kContextFlags = 0x821E;
constexpr unsigned kContextProfileMask = 0x9126;
constexpr unsigned kDebugOutput = 0x92E0;
constexpr unsigned kDebugBit = 2;
constexpr unsigned kStaticDraw = 0x88E4;
constexpr unsigned kFragmentShader = 0x8B30;

template<class Function>
Function* glFunction(const Context& context, const char* name) {
    return reinterpret_cast<Function*>(context.getProcAddress(name));
}

int glInteger(const Context& context, unsigned name) {
    int value = -1;
    glFunction<void(unsigned, int*)>(context, "glGetIntegerv")(name, &value);
    return value;
}

/// A buffer with four bytes, and those bytes again.
unsigned makeBuffer(const Context& context, unsigned content) {
    unsigned buffer = 0;
    glFunction<void(int, unsigned*)>(context, "glCreateBuffers")(1, &buffer);
    glFunction<void(unsigned, std::ptrdiff_t, const void*, unsigned)>(context, "glNamedBufferData")(
        buffer, sizeof content, &content, kStaticDraw);
    return buffer;
}
unsigned readBuffer(const Context& context, unsigned buffer) {
    unsigned content = 0;
    glFunction<void(unsigned, std::ptrdiff_t, std::ptrdiff_t, void*)>(
        context, "glGetNamedBufferSubData")(buffer, 0, sizeof content, &content);
    return content;
}
unsigned glError(const Context& context) {
    return glFunction<unsigned()>(context, "glGetError")();
}

ContextDesc of(ContextApi api) {
    ContextDesc desc;
    desc.api = api;
    return desc;
}

class EachApi : public testing::TestWithParam<ContextApi> {};

INSTANTIATE_TEST_SUITE_P(Headless, EachApi, testing::Values(ContextApi::Egl, ContextApi::OsMesa),
                         [](const auto& parameter) {
                             return parameter.param == ContextApi::Egl ? "Egl" : "OsMesa";
                         });

TEST_P(EachApi, GivesCoreProfile45Current) {
    const auto context = Context::create(of(GetParam()));
    ASSERT_TRUE(context) << context.error().text;
    EXPECT_TRUE(context->isCurrent());
    EXPECT_EQ(context->info().api, GetParam());
    EXPECT_GE(10 * glInteger(*context, kMajorVersion) + glInteger(*context, kMinorVersion), 45);
    EXPECT_EQ(glInteger(*context, kContextProfileMask) & 1, 1);
    EXPECT_EQ(glError(*context), 0U);
    EXPECT_THAT(context->describe(),
                AllOf(HasSubstr(GetParam() == ContextApi::Egl ? "EGL " : "OSMesa, "),
                      HasSubstr(context->info().renderer), HasSubstr("OpenGL 4.")));
    RecordProperty("context", context->describe());
    EXPECT_EQ(reinterpret_cast<void*>(context->loader()("glFinish")),
              context->getProcAddress("glFinish"));
}

TEST_P(EachApi, ServesAnOlderCoreProfileToo) {
    ContextDesc desc = of(GetParam());
    desc.majorVersion = 3;
    desc.minorVersion = 3;
    const auto context = Context::create(desc);
    ASSERT_TRUE(context) << context.error().text;
    EXPECT_GE(10 * glInteger(*context, kMajorVersion) + glInteger(*context, kMinorVersion), 33);
}

TEST_P(EachApi, DebugContext) {
    for (const bool debug : {false, true}) {
        ContextDesc desc = of(GetParam());
        desc.debug = debug;
        const auto context = Context::create(desc);
        ASSERT_TRUE(context) << context.error().text;
        const auto isEnabled = glFunction<unsigned char(unsigned)>(*context, "glIsEnabled");
        EXPECT_EQ(isEnabled(kDebugOutput) != 0, debug);
        if (GetParam() == ContextApi::Egl) {
            EXPECT_EQ((glInteger(*context, kContextFlags) & kDebugBit) != 0, debug);
        }

        // Messages arrive: an invalid enumerator must be reported where debug was asked for.
        int messageCount = 0;
        using Callback =
            void(unsigned, unsigned, unsigned, unsigned, int, const char*, const void*);
        const auto count = [](unsigned, unsigned, unsigned, unsigned, int, const char*,
                              const void* user) { ++*static_cast<int*>(const_cast<void*>(user)); };
        glFunction<void(Callback*, const void*)>(*context, "glDebugMessageCallback")(+count,
                                                                                     &messageCount);
        glFunction<void(unsigned)>(*context, "glEnable")(0xFFFFU);
        glFunction<void()>(*context, "glFinish")();
        EXPECT_EQ(messageCount > 0, debug);
    }
}

TEST_P(EachApi, RefusesAVersionThatDoesNotExist) {
    ContextDesc desc = of(GetParam());
    desc.majorVersion = 9;
    desc.minorVersion = 9;
    const auto context = Context::create(desc);
    ASSERT_FALSE(context);
    EXPECT_EQ(context.error().code, ErrorCode::NoContext);
    EXPECT_THAT(context.error().text, StartsWith("create context: expected OpenGL 9.9 core from "));
}

TEST_P(EachApi, FiftyCycles) {
    for (int i = 0; i < 50; ++i) {
        const auto context = Context::create(of(GetParam()));
        ASSERT_TRUE(context) << "cycle " << i << ": " << context.error().text;
        const unsigned buffer = makeBuffer(*context, 7U);
        ASSERT_EQ(readBuffer(*context, buffer), 7U) << "cycle " << i;
    }
}

TEST_P(EachApi, MovesBetweenThreads) {
    auto context = Context::create(of(GetParam()));
    ASSERT_TRUE(context) << context.error().text;
    const unsigned buffer = makeBuffer(*context, 41U);
    context->doneCurrent();
    EXPECT_FALSE(context->isCurrent());
    std::thread([&] {
        EXPECT_FALSE(context->isCurrent());
        const auto done = context->makeCurrent();
        ASSERT_TRUE(done) << done.error().text;
        EXPECT_EQ(readBuffer(*context, buffer), 41U);
        context->doneCurrent();
    }).join();
    ASSERT_TRUE(context->makeCurrent());
    EXPECT_EQ(readBuffer(*context, buffer), 41U);
}

TEST_P(EachApi, ThreadsWorkOnTheirOwnContextsAtOnce) {
    std::array<int, 4> wrong{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < wrong.size(); ++t) {
        threads.emplace_back([&, t] {
            for (unsigned i = 0; i < 8; ++i) {
                const auto context = Context::create(of(GetParam()));
                const unsigned content = static_cast<unsigned>(t) * 100 + i;
                if (!context || readBuffer(*context, makeBuffer(*context, content)) != content)
                    ++wrong[t];
            }
        });
    }
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_THAT(wrong, testing::Each(0));
}

TEST_P(EachApi, CompilerLogsLeadToTheSource) {
    const auto context = Context::create(of(GetParam()));
    ASSERT_TRUE(context) << context.error().text;
    const auto shader = gl::flattenShader("voxelize/a.frag", [](std::string_view name) {
        return std::optional<std::string>(name == "voxelize/a.frag"
                                              ? "\n#include <lamina/x.glsl>\nvoid main() { f(); }\n"
                                              : "void g() {}\n\nvoid f() {\n    missing = 1;\n}\n");
    });
    ASSERT_TRUE(shader) << shader.error().text;
    const std::string text = gl::assemble(*shader, {});
    const char* const strings[] = {text.c_str()};
    const unsigned id = glFunction<unsigned(unsigned)>(*context, "glCreateShader")(kFragmentShader);
    glFunction<void(unsigned, int, const char* const*, const int*)>(*context, "glShaderSource")(
        id, 1, strings, nullptr);
    glFunction<void(unsigned)>(*context, "glCompileShader")(id);
    std::array<char, 1024> log{};
    glFunction<void(unsigned, int, int*, char*)>(*context, "glGetShaderInfoLog")(
        id, static_cast<int>(log.size()), nullptr, log.data());
    EXPECT_THAT(gl::translateLog(log.data(), shader->files), StartsWith("lamina/x.glsl:4: error"));
}

TEST(Headless, AutomaticChoiceWorks) {
    const auto context = Context::create();
    ASSERT_TRUE(context) << context.error().text;
    EXPECT_EQ(context->info().api, ContextApi::Egl) << context->describe();
}

TEST(Headless, AutomaticChoiceFallsBackAndSaysWhy) {
    ContextDesc desc;
    desc.eglLibrary = "libnone-egl.so";
    const auto context = Context::create(desc);
    ASSERT_TRUE(context) << context.error().text;
    EXPECT_EQ(context->info().api, ContextApi::OsMesa);
    ASSERT_EQ(context->attempts().size(), 1U);
    EXPECT_THAT(context->attempts()[0], AllOf(StartsWith("EGL: "), HasSubstr("libnone-egl.so")));
}

TEST(Headless, ErrorNamesEveryFailure) {
    ContextDesc desc;
    desc.majorVersion = 9;
    desc.minorVersion = 9;
    const auto version = Context::create(desc);
    ASSERT_FALSE(version);
    EXPECT_THAT(version.error().text,
                AllOf(HasSubstr("EGL device 0"), HasSubstr("EGL surfaceless: "),
                      HasSubstr("EGL pbuffer: "), HasSubstr("OSMesa: ")));

    desc = ContextDesc{};
    desc.eglLibrary = "libnone-egl.so";
    desc.osMesaLibrary = "libm.so.6";
    const auto libraries = Context::create(desc);
    ASSERT_FALSE(libraries);
    EXPECT_THAT(libraries.error().text,
                AllOf(HasSubstr("EGL: libnone-egl.so"), HasSubstr("OSMesa: libm.so.6 lacks")));

    desc = of(ContextApi::Egl);
    desc.eglDevice = 1000;
    const auto device = Context::create(desc);
    ASSERT_FALSE(device);
    EXPECT_THAT(device.error().text,
                AllOf(HasSubstr("expected device 1000"), Not(HasSubstr("surfaceless")),
                      Not(HasSubstr("OSMesa:"))));

    desc = ContextDesc{};
    desc.majorVersion = 2;
    const auto old = Context::create(desc);
    ASSERT_FALSE(old);
    EXPECT_EQ(old.error().code, ErrorCode::InvalidArgument);
}

TEST(Headless, EachEglPlatformByName) {
    const std::array<std::pair<EglPlatform, const char*>, 3> platforms = {
        {{EglPlatform::Device, "EGL device"},
         {EglPlatform::Surfaceless, "EGL surfaceless"},
         {EglPlatform::Pbuffer, "EGL pbuffer"}}};
    for (const auto& [platform, kind] : platforms) {
        ContextDesc desc = of(ContextApi::Egl);
        desc.eglPlatform = platform;
        const auto context = Context::create(desc);
        ASSERT_TRUE(context) << context.error().text;
        EXPECT_THAT(context->info().kind, StartsWith(kind));
        EXPECT_TRUE(context->attempts().empty());
    }
    ContextDesc first = of(ContextApi::Egl);
    first.eglDevice = 0;
    const auto context = Context::create(first);
    ASSERT_TRUE(context) << context.error().text;
    EXPECT_THAT(context->info().kind, StartsWith("EGL device 0"));
}

TEST(Headless, AFailureLeavesTheOldContextCurrent) {
    for (const ContextApi api : {ContextApi::Egl, ContextApi::OsMesa}) {
        const auto context = Context::create(of(api));
        ASSERT_TRUE(context) << context.error().text;
        const unsigned buffer = makeBuffer(*context, 5U);
        ContextDesc impossible;
        impossible.majorVersion = 9;
        ASSERT_FALSE(Context::create(impossible));
        EXPECT_TRUE(context->isCurrent());
        EXPECT_EQ(readBuffer(*context, buffer), 5U);
    }
}

/// The host's own context, made without us, is current again after a failure; what the host
/// chose with eglBindAPI stays.
TEST(Headless, RespectsTheHostsEglState) {
    auto lender = Context::create(of(ContextApi::Egl));
    ASSERT_TRUE(lender) << lender.error().text;
    void* library = dlopen("libEGL.so.1", RTLD_NOW);
    ASSERT_NE(library, nullptr);
    const auto queryApi = reinterpret_cast<unsigned (*)()>(dlsym(library, "eglQueryAPI"));
    const auto bindApi = reinterpret_cast<unsigned (*)(unsigned)>(dlsym(library, "eglBindAPI"));
    const auto current = reinterpret_cast<void* (*)()>(dlsym(library, "eglGetCurrentContext"));
    constexpr unsigned kOpenGlEs = 0x30A0;
    void* const hostContext = current();
    ASSERT_NE(hostContext, nullptr);
    const unsigned before = queryApi();
    bindApi(kOpenGlEs);
    ContextDesc impossible = of(ContextApi::Egl);
    impossible.majorVersion = 9;
    EXPECT_FALSE(Context::create(impossible));
    EXPECT_EQ(queryApi(), kOpenGlEs);
    EXPECT_EQ(current(), hostContext);
    bindApi(before);
}

class SideBySide : public testing::TestWithParam<std::pair<ContextApi, ContextApi>> {};

INSTANTIATE_TEST_SUITE_P(Headless, SideBySide,
                         testing::Values(std::pair(ContextApi::Egl, ContextApi::Egl),
                                         std::pair(ContextApi::Egl, ContextApi::OsMesa),
                                         std::pair(ContextApi::OsMesa, ContextApi::Egl),
                                         std::pair(ContextApi::OsMesa, ContextApi::OsMesa)));

TEST_P(SideBySide, TwoContextsOnOneThread) {
    auto first = Context::create(of(GetParam().first));
    ASSERT_TRUE(first) << first.error().text;
    const unsigned firstBuffer = makeBuffer(*first, 11U);
    auto second = Context::create(of(GetParam().second));
    ASSERT_TRUE(second) << second.error().text;
    EXPECT_FALSE(first->isCurrent());
    EXPECT_TRUE(second->isCurrent());
    const unsigned secondBuffer = makeBuffer(*second, 22U);
    EXPECT_EQ(firstBuffer, secondBuffer) << "the contexts share objects";

    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(first->makeCurrent());
        EXPECT_TRUE(first->isCurrent());
        EXPECT_FALSE(second->isCurrent());
        EXPECT_EQ(readBuffer(*first, firstBuffer), 11U);
        ASSERT_TRUE(second->makeCurrent());
        EXPECT_EQ(readBuffer(*second, secondBuffer), 22U);
    }
    // Destroying the one that is not current leaves the other at work.
    { const Context gone = std::move(*first); }
    EXPECT_TRUE(second->isCurrent());
    EXPECT_EQ(readBuffer(*second, secondBuffer), 22U);
    EXPECT_EQ(glError(*second), 0U);
}

TEST_P(SideBySide, MoveAssignmentDestroysTheOldContext) {
    auto first = Context::create(of(GetParam().first));
    auto second = Context::create(of(GetParam().second));
    ASSERT_TRUE(first && second);
    const unsigned buffer = makeBuffer(*second, 33U);
    *first = std::move(*second);
    EXPECT_TRUE(first->isCurrent());
    EXPECT_EQ(first->info().api, GetParam().second);
    EXPECT_EQ(readBuffer(*first, buffer), 33U);
    first->doneCurrent();
    EXPECT_FALSE(first->isCurrent());
}

TEST(Headless, CurrentElsewhereIsAnError) {
    auto context = Context::create(of(ContextApi::Egl));
    ASSERT_TRUE(context) << context.error().text;
    std::thread([&] {
        const auto done = context->makeCurrent();
        ASSERT_FALSE(done);
        EXPECT_THAT(done.error().text,
                    AllOf(StartsWith("make context current: "), HasSubstr("EGL_BAD_ACCESS")));
    }).join();
    EXPECT_TRUE(context->isCurrent());
}

} // namespace
} // namespace lamina::headless

int main(int count, char** arguments) {
    // Without an X server the default display needs to be told what it is.
    setenv("EGL_PLATFORM", "surfaceless", 0);
    testing::InitGoogleTest(&count, arguments);
    return RUN_ALL_TESTS();
}
