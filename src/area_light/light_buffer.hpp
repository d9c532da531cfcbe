#pragma once

#include "gl/device_state.hpp"

#include <lamina/area_light/area_light.hpp>

#include <span>

namespace lamina {

/// The virtual lights in GL memory, as lamina/area_light.glsl reads them.
class LightBuffer {
public:
    /// Errors: ShaderError.
    [[nodiscard]] static Result<LightBuffer> create(std::shared_ptr<gl::DeviceState> device);

    /// texture: of a light source; 0: none. Errors: InvalidArgument (it is no 2D texture).
    [[nodiscard]] Result<void> check(GLuint texture) const;
    /// Lights, medium and query settings of a frame. texture: sound.
    void upload(std::span<const VirtualLight> lights, const Medium& medium,
                const AreaLightDesc& desc, GLuint texture);

    [[nodiscard]] GLuint id() const { return mLights.id(); }

private:
    LightBuffer(std::shared_ptr<gl::DeviceState> device, GLuint tintProgram);
    void tint(std::span<const VirtualLight> lights, GLuint texture);

    std::shared_ptr<gl::DeviceState> mDevice;
    GLuint mTintProgram;
    gl::Buffer mLights;
    gl::Buffer mPlaces;
};

} // namespace lamina
