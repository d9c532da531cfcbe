#pragma once

#include "gl/device_state.hpp"

#include <array>

namespace lamina {

/// Saves the bindings that the rectify and scan kernels use and puts them back: program, image unit
/// 0, storage buffers 0 and 1, texture unit 0 (2D, 2D array, cube map) and its sampler. Pauses
/// transform feedback, during which no other program may come into use.
class EpipolarComputeGuard {
public:
    explicit EpipolarComputeGuard(gl::DeviceState& device);
    ~EpipolarComputeGuard();
    EpipolarComputeGuard(const EpipolarComputeGuard&) = delete;
    EpipolarComputeGuard& operator=(const EpipolarComputeGuard&) = delete;

private:
    struct StorageBinding {
        GLint buffer = 0;
        GLint64 offset = 0;
        GLint64 size = 0;
    };
    static constexpr std::array kTextureTargets = {GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY,
                                                   GL_TEXTURE_CUBE_MAP};

    gl::DeviceState& mDevice;
    GLint mProgram = 0;
    std::array<StorageBinding, 2> mStorage;
    std::array<GLint, 6> mImage{};
    std::array<GLint, kTextureTargets.size()> mTextures{};
    GLint mSampler = 0;
    bool mFeedbackPaused = false;
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
