#pragma once

#include "gl/glad.hpp"

namespace lamina {

/// Filtering across the edges of cube maps while it lives; then as the host had it.
class SeamlessCubeMaps {
public:
    explicit SeamlessCubeMaps(const GladGLContext& gl)
        : mGl(gl)
        , mWas(gl.IsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS)) {
        gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    }
    ~SeamlessCubeMaps() {
        if (!mWas)
            mGl.Disable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    }
    SeamlessCubeMaps(const SeamlessCubeMaps&) = delete;
    SeamlessCubeMaps& operator=(const SeamlessCubeMaps&) = delete;

private:
    const GladGLContext& mGl;
    GLboolean mWas;
};

} // namespace lamina
