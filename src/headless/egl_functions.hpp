#pragma once

#include "headless/dynamic_library.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>
#include <string_view>

namespace lamina::headless {

/// The functions of an EGL library that we call.
struct Egl {
    PFNEGLBINDAPIPROC bindApi;
    PFNEGLCHOOSECONFIGPROC chooseConfig;
    PFNEGLCREATECONTEXTPROC createContext;
    PFNEGLCREATEPBUFFERSURFACEPROC createPbufferSurface;
    PFNEGLDESTROYCONTEXTPROC destroyContext;
    PFNEGLDESTROYSURFACEPROC destroySurface;
    PFNEGLGETCURRENTCONTEXTPROC getCurrentContext;
    PFNEGLGETCURRENTDISPLAYPROC getCurrentDisplay;
    PFNEGLGETCURRENTSURFACEPROC getCurrentSurface;
    PFNEGLGETDISPLAYPROC getDisplay;
    PFNEGLGETERRORPROC getError;
    PFNEGLGETPROCADDRESSPROC getProcAddress;
    PFNEGLINITIALIZEPROC initialize;
    PFNEGLMAKECURRENTPROC makeCurrent;
    PFNEGLQUERYAPIPROC queryApi;
    PFNEGLQUERYSTRINGPROC queryString;

    // Of extensions: null where the library has none.
    PFNEGLGETPLATFORMDISPLAYEXTPROC getPlatformDisplay;
    PFNEGLQUERYDEVICESEXTPROC queryDevices;
    PFNEGLQUERYDEVICESTRINGEXTPROC queryDeviceString;

    /// Whether all functions but those of extensions were found.
    [[nodiscard]] bool load(const DynamicLibrary& library);

    /// The last error of the calling thread by name, e.g. "EGL_BAD_MATCH".
    [[nodiscard]] std::string errorName() const;

    /// A display's extension string, or the client's for EGL_NO_DISPLAY; empty if there is none.
    [[nodiscard]] std::string_view extensions(EGLDisplay display) const;
};

/// Whether a space-separated list holds `extension`.
[[nodiscard]] bool hasExtension(std::string_view list, std::string_view extension);

} // namespace lamina::headless
