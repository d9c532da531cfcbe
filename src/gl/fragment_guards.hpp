#pragma once

#include "gl/device_state.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace lamina::gl {

enum class Blending : std::uint8_t {
    Off,
    Add,     ///< source + destination
    Minimum, ///< by component
};

/// Saves the blending and dithering state of the first `targets` draw buffers, sets `blending`
/// without dithering, and puts the old state back when it goes out of scope. Complements
/// RasterStateGuard.
class BlendStateGuard {
public:
    LAMINA_API BlendStateGuard(DeviceState& device, GLuint targets, Blending blending);
    LAMINA_API ~BlendStateGuard();
    BlendStateGuard(const BlendStateGuard&) = delete;
    BlendStateGuard& operator=(const BlendStateGuard&) = delete;

private:
    struct Target {
        GLboolean isEnabled = GL_FALSE;
        GLint sourceRgb = 0, sourceAlpha = 0, destinationRgb = 0, destinationAlpha = 0;
        GLint equationRgb = 0, equationAlpha = 0;
    };

    DeviceState& mDevice;
    GLboolean mDither = GL_FALSE;
    std::vector<Target> mTargets;
};

/// Adds to a RasterStateGuard what a pass with a depth buffer touches, and sets what our depth maps
/// expect: test `function`, depths in [0,1] written, no offset. Create it after the
/// RasterStateGuard, which restores the clip control.
class DepthStateGuard {
public:
    LAMINA_API DepthStateGuard(DeviceState& device, GLenum function);
    LAMINA_API ~DepthStateGuard();
    DepthStateGuard(const DepthStateGuard&) = delete;
    DepthStateGuard& operator=(const DepthStateGuard&) = delete;

private:
    DeviceState& mDevice;
    GLboolean mTest, mClamp, mOffset;
    GLint mFunction = GL_LESS;
    GLboolean mWritten = GL_TRUE;
    std::array<GLdouble, 2> mRange{};
};

} // namespace lamina::gl
