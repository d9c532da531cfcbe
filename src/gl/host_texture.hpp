#pragma once

#include "gl/device_state.hpp"

#include <glm/vec2.hpp>

#include <string_view>

namespace lamina::gl {

/// A host's depths and the FetchSampler to read them with.
struct SampledDepths {
    GLuint texture = 0;
    GLuint sampler = 0;

    void bind(const GladGLContext& gl, GLuint unit) const {
        gl.BindTextureUnit(unit, texture);
        gl.BindSampler(unit, sampler);
    }
};

/// Least step between the depths that a texture holds: of a fixed-point format; 0 for a float one.
/// Errors: InvalidArgument, if it is not a 2D texture of `size` texels that a shader can read
/// depths from; the text is begun by `operation`.
[[nodiscard]] LAMINA_API Result<double> depthStep(const DeviceState& device, GLuint texture,
                                                  const glm::uvec2& size,
                                                  std::string_view operation);

} // namespace lamina::gl
