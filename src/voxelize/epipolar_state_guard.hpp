#pragma once

#include "gl/device_state.hpp"

#include <array>

namespace lamina {

/// Adds to a ComputeStateGuard the bindings that the rectify and scan kernels use: image unit 0,
/// texture unit 0 (2D, 2D array, cube map) and its sampler.
class EpipolarBindingsGuard {
public:
    explicit EpipolarBindingsGuard(gl::DeviceState& device);
    ~EpipolarBindingsGuard();
    EpipolarBindingsGuard(const EpipolarBindingsGuard&) = delete;
    EpipolarBindingsGuard& operator=(const EpipolarBindingsGuard&) = delete;

private:
    static constexpr std::array kTextureTargets = {GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY,
                                                   GL_TEXTURE_CUBE_MAP};

    gl::DeviceState& mDevice;
    std::array<GLint, 6> mImage{};
    std::array<GLint, kTextureTargets.size()> mTextures{};
    GLint mSampler = 0;
};

/// Adds to a RasterStateGuard what a pass with a depth buffer touches, and sets what our depth maps
/// expect: nearest is greatest, depths in [0,1], no offset. Create it after the RasterStateGuard.
class EpipolarDepthGuard {
public:
    explicit EpipolarDepthGuard(gl::DeviceState& device);
    ~EpipolarDepthGuard();
    EpipolarDepthGuard(const EpipolarDepthGuard&) = delete;
    EpipolarDepthGuard& operator=(const EpipolarDepthGuard&) = delete;

private:
    gl::DeviceState& mDevice;
    GLboolean mTest, mClamp, mOffset;
    GLint mFunction = GL_LESS;
    GLboolean mWritten = GL_TRUE;
    std::array<GLdouble, 2> mRange{};
};

} // namespace lamina
