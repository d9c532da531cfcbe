#include "refraction_stage.hpp"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <map>

namespace example {
namespace {

constexpr const char* kSkyVertex = R"(#version 450
layout(location = 0) uniform mat4 clipToWorld;
layout(location = 1) uniform vec3 eye;
out vec3 ray;
void main() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    vec4 far = clipToWorld * vec4(corner, 0.9, 1.0);
    ray = far.xyz / far.w - eye;
    gl_Position = vec4(corner, 1.0, 1.0);
}
)";
constexpr const char* kSkyFragment = R"(#version 450
layout(binding = 0) uniform samplerCube environment;
in vec3 ray;
out vec4 color;
void main() {
    color = vec4(textureLod(environment, ray, 0.0).rgb, 1.0);
}
)";
constexpr const char* kVertexMain = R"(
layout(location = 0) uniform mat4 worldToClip;
layout(location = 1) uniform mat4 model;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 worldNormal;
void main() {
    vec3 place = position;
    worldNormal = normal;
    deform(place, worldNormal);
    worldNormal = mat3(model) * worldNormal;
    gl_Position = worldToClip * model * vec4(place, 1.0);
}
)";
constexpr const char* kStill = "void deform(inout vec3 position, inout vec3 normal) {}\n";
constexpr const char* kObjectFragment = R"(#version 450
layout(location = 3) uniform uint object;
in vec3 worldNormal;
layout(location = 0) out vec4 normal;
layout(location = 1) out uint id;
void main() {
    normal = vec4(normalize(worldNormal), 0.0);
    id = object;
}
)";
constexpr const char* kOpaqueFragment = R"(#version 450
layout(location = 3) uniform vec3 albedo;
in vec3 worldNormal;
layout(location = 0) out vec4 color;
void main() {
    vec3 normal = normalize(worldNormal);
    float sun = max(dot(normal, normalize(vec3(0.55, 0.62, 0.56))), 0.0);
    color = vec4(albedo * (0.30 + 0.15 * normal.y + 1.1 * sun), 1.0);
}
)";

GLuint makeTexture(const HostGl& gl, GLenum format, const glm::uvec2& size) {
    GLuint texture = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, format, static_cast<GLsizei>(size.x),
                        static_cast<GLsizei>(size.y));
    return texture;
}

/// Programs by their text, made once.
GLuint programOf(const HostGl& gl, const std::string& vertex, const char* fragment) {
    static std::map<std::string, GLuint> made;
    GLuint& program = made[vertex + fragment];
    if (program == 0)
        program = makeProgram(gl, {{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}});
    return program;
}

void drawMesh(const HostGl& gl, const Stage& stage, GLuint frame, GLuint program,
              const EngineMesh& mesh, const glm::mat4& model) {
    const glm::mat4 worldToClip(stage.view.worldToClip);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(worldToClip));
    gl.ProgramUniformMatrix4fv(program, 1, 1, GL_FALSE, glm::value_ptr(model));
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame);
    gl.Viewport(0, 0, static_cast<GLsizei>(stage.view.size.x),
                static_cast<GLsizei>(stage.view.size.y));
    gl.Enable(GL_DEPTH_TEST);
    gl.UseProgram(program);
    draw(gl, mesh);
    gl.Disable(GL_DEPTH_TEST);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

} // namespace

void addNormals(lamina::TriangleMesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), glm::vec3(0.0f));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 a = mesh.positions[t.x];
        const glm::vec3 normal = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
        for (int corner = 0; corner < 3; ++corner)
            mesh.normals[t[corner]] += normal;
    }
    for (glm::vec3& normal : mesh.normals)
        normal = normal == glm::vec3(0.0f) ? glm::vec3(0, 1, 0) : glm::normalize(normal);
}

Stage makeStage(const HostGl& gl, const glm::uvec2& size, const glm::dvec3& eye,
                const glm::dvec3& target, double fieldOfView) {
    Stage stage;
    stage.eye = eye;
    stage.view.size = size;
    stage.view.worldToClip = glm::perspective(glm::radians(fieldOfView),
                                              static_cast<double>(size.x) / size.y, 0.1, 100.0) *
                             glm::lookAt(eye, target, glm::dvec3(0, 1, 0));
    stage.color = makeTexture(gl, GL_RGBA16F, size);
    stage.colorDepth = makeTexture(gl, GL_DEPTH_COMPONENT32F, size);
    stage.depth = makeTexture(gl, GL_DEPTH_COMPONENT32F, size);
    stage.normals = makeTexture(gl, GL_RGBA16F, size);
    stage.objects = makeTexture(gl, GL_R32UI, size);
    GLuint frames[2];
    gl.CreateFramebuffers(2, frames);
    stage.colorFrame = frames[0];
    stage.objectFrame = frames[1];
    gl.NamedFramebufferTexture(frames[0], GL_COLOR_ATTACHMENT0, stage.color, 0);
    gl.NamedFramebufferTexture(frames[0], GL_DEPTH_ATTACHMENT, stage.colorDepth, 0);
    gl.NamedFramebufferTexture(frames[1], GL_COLOR_ATTACHMENT0, stage.normals, 0);
    gl.NamedFramebufferTexture(frames[1], GL_COLOR_ATTACHMENT1, stage.objects, 0);
    gl.NamedFramebufferTexture(frames[1], GL_DEPTH_ATTACHMENT, stage.depth, 0);
    constexpr GLenum kOutputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl.NamedFramebufferDrawBuffers(frames[1], 2, kOutputs);
    return stage;
}

void beginStage(const HostGl& gl, const Stage& stage, GLuint environment) {
    constexpr GLfloat kFarthest = 1.0f;
    gl.ClearNamedFramebufferfv(stage.colorFrame, GL_DEPTH, 0, &kFarthest);
    gl.ClearNamedFramebufferfv(stage.objectFrame, GL_DEPTH, 0, &kFarthest);
    const GLuint program = programOf(gl, kSkyVertex, kSkyFragment);
    const glm::mat4 clipToWorld(glm::inverse(stage.view.worldToClip));
    const glm::vec3 eye(stage.eye);
    gl.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, glm::value_ptr(clipToWorld));
    gl.ProgramUniform3fv(program, 1, 1, glm::value_ptr(eye));
    GLuint array = 0;
    gl.CreateVertexArrays(1, &array);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, stage.colorFrame);
    gl.Viewport(0, 0, static_cast<GLsizei>(stage.view.size.x),
                static_cast<GLsizei>(stage.view.size.y));
    gl.BindTextureUnit(0, environment);
    gl.BindVertexArray(array);
    gl.UseProgram(program);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

void drawOpaque(const HostGl& gl, const Stage& stage, const EngineMesh& mesh,
                const glm::mat4& model, const glm::vec3& albedo) {
    const GLuint program =
        programOf(gl, std::string("#version 450\n") + kStill + kVertexMain, kOpaqueFragment);
    gl.ProgramUniform3fv(program, 3, 1, glm::value_ptr(albedo));
    drawMesh(gl, stage, stage.colorFrame, program, mesh, model);
}

void drawObject(const HostGl& gl, const Stage& stage, const EngineMesh& mesh,
                const glm::mat4& model, std::uint32_t object, const std::string& vertexStage,
                float time) {
    const GLuint program =
        programOf(gl, "#version 450\n" + (vertexStage.empty() ? kStill : vertexStage) + kVertexMain,
                  kObjectFragment);
    if (!vertexStage.empty())
        gl.ProgramUniform1f(program, 2, time);
    gl.ProgramUniform1ui(program, 3, object);
    drawMesh(gl, stage, stage.objectFrame, program, mesh, model);
}

lamina::Image develop(const HostGl& gl, const Stage& stage, GLuint color) {
    const glm::uvec2 size = stage.view.size;
    std::vector<glm::vec4> texels(std::size_t{size.x} * size.y);
    gl.GetTextureImage(color, 0, GL_RGBA, GL_FLOAT,
                       static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    const auto shown = [&](std::uint32_t x, std::uint32_t y) {
        const glm::vec3 light(texels[std::size_t{y} * size.x + x]);
        // Linear up to 0.7, then ever flatter towards white.
        const glm::vec3 over = glm::max(light - 0.7f, 0.0f);
        return glm::min(light, 0.7f) + 0.3f * over / (over + 0.6f);
    };
    lamina::Image image{size.x / 2, size.y / 2, {}};
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const std::uint32_t top = size.y - 2 - 2 * y; // Images begin at the top.
            const glm::vec3 mean = 0.25f * (shown(2 * x, top) + shown(2 * x + 1, top) +
                                            shown(2 * x, top + 1) + shown(2 * x + 1, top + 1));
            const glm::vec3 encoded = glm::pow(mean, glm::vec3(1.0f / 2.2f));
            for (int channel = 0; channel < 3; ++channel)
                image.rgba.push_back(static_cast<std::uint8_t>(
                    glm::clamp(encoded[channel], 0.0f, 1.0f) * 255.0f + 0.5f));
            image.rgba.push_back(255);
        }
    return image;
}

lamina::Image sideBySide(const std::vector<lamina::Image>& images) {
    lamina::Image row{0, images.front().height, {}};
    for (const lamina::Image& image : images)
        row.width += image.width;
    for (std::uint32_t y = 0; y < row.height; ++y)
        for (const lamina::Image& image : images) {
            const auto line = image.rgba.begin() + std::size_t{4} * y * image.width;
            row.rgba.insert(row.rgba.end(), line, line + std::size_t{4} * image.width);
        }
    return row;
}

} // namespace example
