#pragma once

#include "gl/device_state.hpp"

#include <lamina/shadow_volumes/shadow_topology.hpp>

namespace lamina {

struct ShadowTopology::Impl {
    gl::Buffer triangles; ///< 32-bit indices, GL_TRIANGLES.
    gl::Buffer edges;     ///< 32-bit indices, GL_LINES_ADJACENCY.
    std::uint32_t triangleCount = 0;
    std::uint32_t edgeCount = 0;
    std::uint32_t openEdgeCount = 0;
    std::uint32_t vertexCount = 0;
    CasterSurface surface = CasterSurface::Closed;
};

} // namespace lamina
