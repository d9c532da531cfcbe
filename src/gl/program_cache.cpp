#include "gl/program_cache.hpp"

#include "gl/shader_library.hpp"

#include <utility>

namespace lamina::gl {
namespace {

std::string cacheKey(const ProgramDesc& desc) {
    std::string key;
    // No shader name or GLSL text holds a NUL byte.
    const auto append = [&](std::string_view part) {
        key.append(part);
        key.push_back('\0');
    };
    for (const ProgramStage& stage : desc.stages) {
        append(stage.shader);
        append(stage.hostSource);
    }
    for (const ShaderDefine& define : desc.defines) {
        append(define.name);
        append(define.value);
    }
    return key;
}

template<class GetParameter, class GetLog>
std::string readLog(GLuint id, GetParameter getParameter, GetLog getLog) {
    GLint length = 0;
    getParameter(id, GL_INFO_LOG_LENGTH, &length);
    if (length <= 1)
        return {};
    std::string log(static_cast<std::size_t>(length), '\0');
    GLsizei written = 0;
    getLog(id, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

class Shader {
public:
    Shader(const GladGLContext& gl, GLenum stage)
        : mGl(gl)
        , mId(gl.CreateShader(stage)) {}
    Shader(Shader&& other) noexcept
        : mGl(other.mGl)
        , mId(std::exchange(other.mId, 0)) {}
    ~Shader() { mGl.DeleteShader(mId); }
    [[nodiscard]] GLuint id() const { return mId; }

private:
    const GladGLContext& mGl;
    GLuint mId;
};

Result<Shader> compile(DeviceState& device, const ProgramDesc& desc, const ProgramStage& stage) {
    auto loaded = loadShader(stage.shader, device.desc.shaderOverrideDirectory.string());
    if (!loaded)
        return loaded.error();
    ShaderText text = std::move(*loaded);
    if (!stage.hostSource.empty()) {
        text.text +=
            "\n#line 1 " + std::to_string(text.files.size()) + "\n" + stage.hostSource + "\n";
        text.files.emplace_back("host vertex stage");
    }
    const std::string source = assemble(text, desc.defines);
    const GladGLContext& gl = device.gl;
    Shader shader(gl, stage.stage);
    const char* pointer = source.c_str();
    const auto length = static_cast<GLint>(source.size());
    gl.ShaderSource(shader.id(), 1, &pointer, &length);
    gl.CompileShader(shader.id());
    GLint compiled = GL_FALSE;
    gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
    const std::string log =
        translateLog(readLog(shader.id(), gl.GetShaderiv, gl.GetShaderInfoLog), text.files);
    if (compiled != GL_TRUE)
        return Error{ErrorCode::ShaderError,
                     desc.label + ": expected " +
                         (stage.hostSource.empty() ? stage.shader : "the host vertex stage") +
                         " to compile, found:\n" + log};
    if (!log.empty())
        device.say(MessageSeverity::Warning, desc.label + ": " + log);
    return shader;
}

} // namespace

Result<GLuint> findOrBuildProgram(DeviceState& device, const ProgramDesc& desc) {
    std::string key = cacheKey(desc);
    if (const auto found = device.programs.find(key); found != device.programs.end())
        return found->second;

    if (auto current = checkContext(device, desc.label); !current)
        return current.error();
    const GladGLContext& gl = device.gl;
    std::vector<Shader> shaders;
    for (const ProgramStage& stage : desc.stages) {
        auto shader = compile(device, desc, stage);
        if (!shader)
            return shader.error();
        shaders.push_back(std::move(*shader));
    }
    const GLuint program = gl.CreateProgram();
    for (const Shader& shader : shaders)
        gl.AttachShader(program, shader.id());
    gl.LinkProgram(program);
    for (const Shader& shader : shaders)
        gl.DetachShader(program, shader.id());
    GLint linked = GL_FALSE;
    gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        const std::string log = readLog(program, gl.GetProgramiv, gl.GetProgramInfoLog);
        gl.DeleteProgram(program);
        return Error{ErrorCode::ShaderError,
                     desc.label + ": expected the program to link, found:\n" + log};
    }
    detail::labelObject(device, ObjectKind::Program, program, desc.label);
    device.programs.emplace(std::move(key), program);
    return program;
}

} // namespace lamina::gl
