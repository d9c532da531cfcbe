#pragma once

#include "gl/device_state.hpp"

#include <array>

namespace lamina::gl {

/// Adds to a RasterStateGuard and a DepthStateGuard what a stencil pass touches: the stencil test
/// of both faces, the polygon offset's amounts. Enables the test; puts all back when it goes out of
/// scope.
class StencilStateGuard {
public:
    LAMINA_API explicit StencilStateGuard(DeviceState& device);
    LAMINA_API ~StencilStateGuard();
    StencilStateGuard(const StencilStateGuard&) = delete;
    StencilStateGuard& operator=(const StencilStateGuard&) = delete;

private:
    struct Face {
        GLint function = GL_ALWAYS, reference = 0, mask = 0, writeMask = 0;
        GLint fail = GL_KEEP, depthFail = GL_KEEP, pass = GL_KEEP;
    };

    DeviceState& mDevice;
    GLboolean mTest;
    std::array<Face, 2> mFaces{}; ///< Front, back.
};

} // namespace lamina::gl
