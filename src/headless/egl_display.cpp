#include "headless/egl_display.hpp"

#include <algorithm>

namespace lamina::headless {
namespace {

struct Device {
    EGLDeviceEXT handle;
    int index;
    bool isSoftware;
    std::string kind;
};

Device describeDevice(const Egl& egl, EGLDeviceEXT handle, int index) {
    Device device{handle, index, false, "EGL device " + std::to_string(index)};
    if (!egl.queryDeviceString)
        return device;
    // The extensions first: old NVIDIA drivers crash when asked for a string they do not know.
    const char* list = egl.queryDeviceString(handle, EGL_EXTENSIONS);
    const std::string_view extensions = list ? list : std::string_view();
    device.isSoftware = hasExtension(extensions, "EGL_MESA_device_software");
    const char* name = nullptr;
    if (device.isSoftware)
        name = "software";
    else if (hasExtension(extensions, "EGL_EXT_device_drm"))
        name = egl.queryDeviceString(handle, EGL_DRM_DEVICE_FILE_EXT);
    if (name)
        device.kind += std::string(" (") + name + ")";
    return device;
}

/// Hardware first, software last, otherwise in EGL's order.
std::vector<Device> listDevices(const Egl& egl) {
    EGLint count = 0;
    if (!egl.queryDevices(0, nullptr, &count) || count <= 0)
        return {};
    std::vector<EGLDeviceEXT> handles(static_cast<std::size_t>(count));
    if (!egl.queryDevices(count, handles.data(), &count))
        return {};
    handles.resize(static_cast<std::size_t>(count));
    std::vector<Device> devices;
    for (const EGLDeviceEXT handle : handles)
        devices.push_back(describeDevice(egl, handle, static_cast<int>(devices.size())));
    std::stable_partition(devices.begin(), devices.end(),
                          [](const Device& device) { return !device.isSoftware; });
    return devices;
}

void addDevices(const Egl& egl, const ContextDesc& desc, std::vector<DisplayCandidate>& candidates,
                Attempts& attempts) {
    const std::string_view client = egl.extensions(EGL_NO_DISPLAY);
    if (!egl.queryDevices || !egl.getPlatformDisplay ||
        !hasExtension(client, "EGL_EXT_platform_device")) {
        attempts.push_back("EGL devices: the library lacks EGL_EXT_device_enumeration or "
                           "EGL_EXT_platform_device");
        return;
    }
    const std::vector<Device> devices = listDevices(egl);
    const std::size_t before = candidates.size();
    for (const Device& device : devices) {
        if (desc.eglDevice >= 0 && device.index != desc.eglDevice)
            continue;
        const auto open = [&egl, handle = device.handle] {
            return egl.getPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, handle, nullptr);
        };
        candidates.push_back({device.kind, open});
    }
    if (candidates.size() == before)
        attempts.push_back(
            "EGL devices: expected " +
            (desc.eglDevice < 0 ? "at least one" : "device " + std::to_string(desc.eglDevice)) +
            ", found " + std::to_string(devices.size()) + " devices");
}

void addSurfaceless(const Egl& egl, std::vector<DisplayCandidate>& candidates, Attempts& attempts) {
    if (!egl.getPlatformDisplay ||
        !hasExtension(egl.extensions(EGL_NO_DISPLAY), "EGL_MESA_platform_surfaceless")) {
        attempts.push_back("EGL surfaceless: the library lacks EGL_MESA_platform_surfaceless");
        return;
    }
    const auto open = [&egl] {
        return egl.getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    };
    candidates.push_back({"EGL surfaceless", open});
}

} // namespace

std::vector<DisplayCandidate> listDisplays(const Egl& egl, const ContextDesc& desc,
                                           Attempts& attempts) {
    const auto wants = [&desc](EglPlatform platform) {
        // Only the device platform can promise a certain device.
        const bool isAny = desc.eglPlatform == EglPlatform::Automatic && desc.eglDevice < 0;
        return isAny || desc.eglPlatform == platform ||
               (desc.eglPlatform == EglPlatform::Automatic && platform == EglPlatform::Device);
    };
    std::vector<DisplayCandidate> candidates;
    if (wants(EglPlatform::Device))
        addDevices(egl, desc, candidates, attempts);
    if (wants(EglPlatform::Surfaceless))
        addSurfaceless(egl, candidates, attempts);
    if (wants(EglPlatform::Pbuffer))
        candidates.push_back(
            {"EGL pbuffer", [&egl] { return egl.getDisplay(EGL_DEFAULT_DISPLAY); }, true});
    return candidates;
}

} // namespace lamina::headless
