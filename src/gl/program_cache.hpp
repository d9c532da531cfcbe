#pragma once

#include "gl/device_state.hpp"
#include "gl/shader_source.hpp"

#include <string>
#include <vector>

namespace lamina::gl {

struct ProgramStage {
    GLenum stage = GL_NONE;
    std::string shader; ///< Name in the shader library: "voxelize/slicemap.frag".
    /// GLSL of the host, appended to `shader`; errors in it read "host vertex stage:line".
    std::string hostSource = {};
};

struct ProgramDesc {
    std::string label; ///< For messages and captures.
    std::vector<ProgramStage> stages;
    std::vector<ShaderDefine> defines;
};

/// The linked program of this description, built at its first use and kept by the device.
/// Errors: ShaderError with the compiler's log, places translated to file and line.
/// Cost: a map look-up after the first use; compiling and linking (milliseconds) before.
[[nodiscard]] LAMINA_API Result<GLuint> findOrBuildProgram(DeviceState& device,
                                                           const ProgramDesc& desc);

} // namespace lamina::gl
