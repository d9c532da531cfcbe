#pragma once

#include "gl/device_state.hpp"

#include <array>
#include <vector>

namespace lamina {

/// Saves the blending and dithering state of the first `targets` draw buffers, sets additive
/// blending without dithering, and puts the old state back when it goes out of scope. Complements
/// gl::RasterStateGuard.
class BlendStateGuard {
public:
    BlendStateGuard(gl::DeviceState& device, GLuint targets);
    ~BlendStateGuard();
    BlendStateGuard(const BlendStateGuard&) = delete;
    BlendStateGuard& operator=(const BlendStateGuard&) = delete;

private:
    struct Target {
        GLboolean isEnabled = GL_FALSE;
        GLint sourceRgb = 0, sourceAlpha = 0, destinationRgb = 0, destinationAlpha = 0;
        GLint equationRgb = 0, equationAlpha = 0;
    };

    gl::DeviceState& mDevice;
    GLboolean mDither = GL_FALSE;
    std::vector<Target> mTargets;
};

/// Saves shader storage buffer binding 0 and the indirect draw buffer, and puts them back when it
/// goes out of scope.
class IndirectDrawGuard {
public:
    explicit IndirectDrawGuard(gl::DeviceState& device);
    ~IndirectDrawGuard();
    IndirectDrawGuard(const IndirectDrawGuard&) = delete;
    IndirectDrawGuard& operator=(const IndirectDrawGuard&) = delete;

private:
    gl::DeviceState& mDevice;
    GLint mIndirect = 0;
    GLint mStorage = 0;
    GLint64 mStorageOffset = 0, mStorageSize = 0;
};

/// Saves image units [0, units) and puts them back when it goes out of scope.
class ImageUnitGuard {
public:
    ImageUnitGuard(gl::DeviceState& device, GLuint units);
    ~ImageUnitGuard();
    ImageUnitGuard(const ImageUnitGuard&) = delete;
    ImageUnitGuard& operator=(const ImageUnitGuard&) = delete;

private:
    struct Unit {
        GLint name = 0, level = 0, layer = 0, access = 0, format = 0;
        GLboolean isLayered = GL_FALSE;
    };

    gl::DeviceState& mDevice;
    std::vector<Unit> mUnits;
};

} // namespace lamina
