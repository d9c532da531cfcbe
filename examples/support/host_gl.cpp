#include "host_gl.hpp"

#include <cstdio>
#include <cstdlib>

namespace example {
namespace {

[[noreturn]] void fail(const char* what, const char* log) {
    std::fprintf(stderr, "%s: %s\n", what, log);
    std::exit(1);
}

GLuint makeShader(const HostGl& gl, GLenum stage, const std::string& source) {
    const GLuint shader = gl.CreateShader(stage);
    const char* text = source.c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    GLint compiled = GL_FALSE;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE) {
        char log[4096] = {};
        gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
        fail("shader", log);
    }
    return shader;
}

} // namespace

HostGl::HostGl(const std::function<void*(const char*)>& load) {
#define EXAMPLE_GL_LOAD(type, name) name = reinterpret_cast<type>(load("gl" #name));
    EXAMPLE_GL_FUNCTIONS(EXAMPLE_GL_LOAD)
#undef EXAMPLE_GL_LOAD
}

GLuint makeBuffer(const HostGl& gl, std::span<const std::byte> bytes) {
    GLuint buffer = 0;
    gl.CreateBuffers(1, &buffer);
    gl.NamedBufferData(buffer, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STATIC_DRAW);
    return buffer;
}

GLuint makeProgram(const HostGl& gl, std::initializer_list<std::pair<GLenum, std::string>> stages) {
    const GLuint program = gl.CreateProgram();
    for (const auto& [stage, source] : stages) {
        const GLuint shader = makeShader(gl, stage, source);
        gl.AttachShader(program, shader);
        gl.DeleteShader(shader);
    }
    gl.LinkProgram(program);
    GLint linked = GL_FALSE;
    gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        char log[4096] = {};
        gl.GetProgramInfoLog(program, sizeof log, nullptr, log);
        fail("program", log);
    }
    return program;
}

} // namespace example
