#include "headless/egl_functions.hpp"

#include <algorithm>
#include <array>

namespace lamina::headless {

bool Egl::load(const DynamicLibrary& library) {
    const bool complete =
        library.load("eglBindAPI", bindApi) && library.load("eglChooseConfig", chooseConfig) &&
        library.load("eglCreateContext", createContext) &&
        library.load("eglCreatePbufferSurface", createPbufferSurface) &&
        library.load("eglDestroyContext", destroyContext) &&
        library.load("eglDestroySurface", destroySurface) &&
        library.load("eglGetCurrentContext", getCurrentContext) &&
        library.load("eglGetCurrentDisplay", getCurrentDisplay) &&
        library.load("eglGetCurrentSurface", getCurrentSurface) &&
        library.load("eglGetDisplay", getDisplay) && library.load("eglGetError", getError) &&
        library.load("eglGetProcAddress", getProcAddress) &&
        library.load("eglInitialize", initialize) && library.load("eglMakeCurrent", makeCurrent) &&
        library.load("eglQueryAPI", queryApi) && library.load("eglQueryString", queryString);
    if (!complete)
        return false;
    const auto find = [this]<class Function>(const char* name, Function& function) {
        function = reinterpret_cast<Function>(getProcAddress(name));
    };
    // A pointer alone proves nothing: the client's extensions say what exists.
    const std::string_view client = extensions(EGL_NO_DISPLAY);
    const bool hasDevices = hasExtension(client, "EGL_EXT_device_base");
    if (hasExtension(client, "EGL_EXT_platform_base"))
        find("eglGetPlatformDisplayEXT", getPlatformDisplay);
    if (hasDevices || hasExtension(client, "EGL_EXT_device_enumeration"))
        find("eglQueryDevicesEXT", queryDevices);
    if (hasDevices || hasExtension(client, "EGL_EXT_device_query"))
        find("eglQueryDeviceStringEXT", queryDeviceString);
    return true;
}

std::string Egl::errorName() const {
    constexpr std::array<const char*, 15> kNames = {
        "EGL_SUCCESS",       "EGL_NOT_INITIALIZED",     "EGL_BAD_ACCESS",
        "EGL_BAD_ALLOC",     "EGL_BAD_ATTRIBUTE",       "EGL_BAD_CONFIG",
        "EGL_BAD_CONTEXT",   "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY",
        "EGL_BAD_MATCH",     "EGL_BAD_NATIVE_PIXMAP",   "EGL_BAD_NATIVE_WINDOW",
        "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",         "EGL_CONTEXT_LOST"};
    const EGLint error = getError();
    const auto index = static_cast<std::size_t>(error - EGL_SUCCESS);
    return index < kNames.size() ? kNames[index] : "EGL error " + std::to_string(error);
}

std::string_view Egl::extensions(EGLDisplay display) const {
    const char* list = queryString(display, EGL_EXTENSIONS);
    if (!list)
        getError(); // EGL without client extensions: the failed query must not be found later.
    return list ? list : std::string_view();
}

bool hasExtension(std::string_view list, std::string_view extension) {
    while (!list.empty()) {
        const std::string_view name = list.substr(0, list.find(' '));
        if (name == extension)
            return true;
        list.remove_prefix(std::min(name.size() + 1, list.size()));
    }
    return false;
}

} // namespace lamina::headless
