#pragma once

#include "gl/device_state.hpp"

#include <vector>

namespace lamina {

/// Saves the texel buffers, 2D array textures and samplers of texture units [0, units) and puts
/// them back when it goes out of scope. Complements gl::ComputeStateGuard.
class TextureUnitGuard {
public:
    TextureUnitGuard(gl::DeviceState& device, GLuint units);
    ~TextureUnitGuard();
    TextureUnitGuard(const TextureUnitGuard&) = delete;
    TextureUnitGuard& operator=(const TextureUnitGuard&) = delete;

private:
    struct Unit {
        GLint buffer = 0, array = 0, sampler = 0;
    };

    gl::DeviceState& mDevice;
    std::vector<Unit> mUnits;
};

} // namespace lamina
