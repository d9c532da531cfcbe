#pragma once

#include "host_gl.hpp"

#include <lamina/grid_io/image.hpp>

namespace example {

/// The engine's multisampled target with depth, and the one it is resolved into.
struct Target {
    GLuint samples = 0;
    GLuint resolved = 0;
    GLsizei width = 0;
    GLsizei height = 0;
};

[[nodiscard]] Target makeTarget(const HostGl& gl, GLsizei width, GLsizei height);

/// Binds the target, sets the viewport, tests depth, and clears depth to 1.
void beginFrame(const HostGl& gl, const Target& target);

/// The picture, resolved.
[[nodiscard]] lamina::Image readBack(const HostGl& gl, const Target& target);

} // namespace example
