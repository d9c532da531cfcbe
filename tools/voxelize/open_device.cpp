#include "open_device.hpp"

#include "failure.hpp"

#include <fmt/format.h>

#include <utility>

namespace lamina::tool {
namespace {

headless::Context createContext(const Request& request) {
    headless::ContextDesc desc;
    desc.api = request.context;
    return require(headless::Context::create(desc));
}

DeviceDesc deviceDesc(const Request& request, StageClock& clock) {
    DeviceDesc desc;
    desc.memoryBudgetBytes = static_cast<std::uint64_t>(request.memoryLimitBytes);
    if (request.verbose)
        desc.message = [&clock](const Message& message) {
            clock.finish();
            fmt::print(stderr, "{} {}\n",
                       message.severity == MessageSeverity::Warning ? "warning  " : "note     ",
                       message.text);
        };
    return desc;
}

} // namespace

void OpenDevice::wait() const {
    reinterpret_cast<void (*)()>(context.getProcAddress("glFinish"))();
}

OpenDevice openDevice(const Request& request, StageClock& clock, RunRecord& record) {
    headless::Context context =
        clock.run("context", "creating a GL context", [&] { return createContext(request); });
    Device device = require(Device::fromCurrentContext(
        [&context](const char* name) { return context.getProcAddress(name); },
        deviceDesc(request, clock)));
    record.renderer = RendererFacts{context.info(),
                                    {context.attempts().begin(), context.attempts().end()},
                                    device.info().isSoftware};
    return {std::move(context), std::move(device)};
}

BitGrid downloadUniform(const VoxelGrid& grid) {
    BitGrid bits = require(grid.download());
    return bits.hasLocalRanges() ? require(bits.toUniform(bits.size().z)) : std::move(bits);
}

} // namespace lamina::tool
