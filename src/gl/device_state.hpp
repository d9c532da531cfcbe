#pragma once

#include "gl/objects.hpp"

#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamina::gl {

/// What a Device and the objects made from it share.
struct DeviceState {
    GladGLContext gl{};
    DeviceDesc desc;
    DeviceInfo info;
    DeviceLimits limits;
    std::uint64_t allocatedBytes = 0;
    /// Linked programs by everything that went into them (program_cache.hpp). Holds raw names,
    /// since owning handles would keep this state alive; ~Device deletes them.
    std::map<std::string, GLuint, std::less<>> programs;
    /// Whether atomics of fragments gather slices faster than render targets, once measured
    /// (voxelize/slicemap_calibration.hpp).
    std::optional<bool> atomicsBeatTargets;

    void say(MessageSeverity severity, const std::string& text) const {
        if (desc.message)
            desc.message({severity, text});
    }
};

/// Errors: NoContext (no context is current on this thread). Another device's context passes: GL
/// functions do not tell.
[[nodiscard]] LAMINA_API Result<void> checkContext(const DeviceState& device,
                                                   std::string_view operation);

/// Errors: InvalidArgument (`other`, the device of `what`, is not this one).
[[nodiscard]] LAMINA_API Result<void> checkSameDevice(const DeviceState& device,
                                                      const DeviceState* other,
                                                      std::string_view operation,
                                                      std::string_view what);

/// Puts the GL work of a scope under a KHR_debug group, for captures and debug output.
class DebugGroup {
public:
    LAMINA_API DebugGroup(DeviceState& device, std::string_view name);
    LAMINA_API ~DebugGroup();
    DebugGroup(const DebugGroup&) = delete;
    DebugGroup& operator=(const DebugGroup&) = delete;

private:
    DeviceState& mDevice;
    bool mPushed = false;
};

} // namespace lamina::gl
