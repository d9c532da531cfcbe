#pragma once

#include "gl/glad.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace lamina::gl {

/// Work groups along x, y and z for that many invocations: along x up to the count that every
/// device has (GL_MAX_COMPUTE_WORK_GROUP_COUNT), the rest along y. Shaders number them y * x count
/// + x.
[[nodiscard]] inline std::array<GLuint, 3> linearGroups(std::uint64_t invocations,
                                                        std::uint64_t groupSize) {
    constexpr std::uint64_t kMaxGroups = 65535;
    const std::uint64_t groups = (invocations + groupSize - 1) / groupSize;
    return {static_cast<GLuint>(std::min(groups, kMaxGroups)),
            static_cast<GLuint>((groups + kMaxGroups - 1) / kMaxGroups), 1};
}

inline void dispatchLinear(const GladGLContext& gl, std::uint64_t invocations,
                           std::uint64_t groupSize) {
    const auto [x, y, z] = linearGroups(invocations, groupSize);
    gl.DispatchCompute(x, y, z);
}

} // namespace lamina::gl
