#include "context_list.hpp"

#include "failure.hpp"

#include <lamina/headless/context.hpp>

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace lamina::tool {
namespace {

struct Way {
    std::string_view name;
    headless::ContextApi api;
    headless::EglPlatform platform;
};

constexpr std::array kWays{
    Way{"egl, device", headless::ContextApi::Egl, headless::EglPlatform::Device},
    Way{"egl, surfaceless", headless::ContextApi::Egl, headless::EglPlatform::Surfaceless},
    Way{"egl, pbuffer", headless::ContextApi::Egl, headless::EglPlatform::Pbuffer},
    Way{"osmesa", headless::ContextApi::OsMesa, headless::EglPlatform::Automatic},
};

} // namespace

void listContexts() {
    bool anyWorks = false;
    for (const Way& way : kWays) {
        headless::ContextDesc desc;
        desc.api = way.api;
        desc.eglPlatform = way.platform;
        const auto context = headless::Context::create(desc);
        anyWorks = anyWorks || context.hasValue();
        fmt::print("{:<18}{}\n", way.name,
                   context ? "works: " + context->describe() : "fails: " + context.error().text);
    }
    if (!anyWorks)
        throw Failure(ExitCode::Failed, "no OpenGL 4.5 context can be made on this machine");
}

} // namespace lamina::tool
