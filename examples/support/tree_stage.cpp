#include "tree_stage.hpp"

#include "shapes.hpp"
#include "tree.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <utility>

namespace example {
namespace {

constexpr const char* kFragmentShader = R"(#version 450
layout(location = 1) uniform vec4 albedo; // alpha: 1 for leaves, which light passes
in vec3 world;
layout(location = 0) out vec4 positions;
layout(location = 1) out vec4 normals;
layout(location = 2) out vec4 colors;
void main() {
    positions = vec4(world, 1.0);
    normals = vec4(normalize(cross(dFdx(world), dFdy(world))), 0.0);
    colors = albedo;
}
)";

/// Leaves by colour: patches of the crown, so that their shadows differ on the ground.
std::array<lamina::TriangleMesh, kLeafClasses> splitByColor(const lamina::TriangleMesh& leaves) {
    std::array<lamina::TriangleMesh, kLeafClasses> split;
    for (lamina::TriangleMesh& mesh : split)
        mesh.positions = leaves.positions;
    for (const glm::uvec3& triangle : leaves.triangles) {
        const float patch = noise(0.9f * leaves.positions[triangle[0]]);
        split[patch < -0.08f ? 1 : patch > 0.08f ? 2 : 0].triangles.push_back(triangle);
    }
    return split;
}

lamina::TriangleMesh makeGround() {
    constexpr float kHalf = 150.0f;
    lamina::TriangleMesh ground;
    ground.positions = {
        {-kHalf, 0, -kHalf}, {kHalf, 0, -kHalf}, {kHalf, 0, kHalf}, {-kHalf, 0, kHalf}};
    ground.triangles = {{0, 2, 1}, {0, 3, 2}};
    return ground;
}

} // namespace

TreeStage::TreeStage(const HostGl& gl, int leavesPerTwig, std::uint32_t size)
    : mGl(gl) {
    Tree tree = makeTree(TreeDesc{.leavesPerTwig = leavesPerTwig, .leafLength = 0.13f});
    mBounds = tree.leaves.bounds();
    mBounds.extend(tree.wood.bounds().min);
    mBounds.extend(tree.wood.bounds().max);
    mLeafMeshes = splitByColor(tree.leaves);
    mWoodMesh = std::move(tree.wood);
    for (std::uint32_t i = 0; i < kLeafClasses; ++i) {
        mLeaves[i] = upload(gl, mLeafMeshes[i]);
        mLeaves[i].view.materialId = i;
    }
    mWood = upload(gl, mWoodMesh);
    mWood.view.materialId = kWoodMaterial;
    mGround = upload(gl, makeGround());
    mView.size = {size, size};
    mView.worldToClip =
        glm::perspective(glm::radians(38.0), 1.0, 0.5, 400.0) *
        glm::lookAt(glm::dvec3(-3.4, 6.4, 15.6), glm::dvec3(1.9, 2.7, 0.9), glm::dvec3(0, 1, 0));
    mProgram = makeProgram(
        gl, {{GL_VERTEX_SHADER, kWorldVertexShader}, {GL_FRAGMENT_SHADER, kFragmentShader}});
    makeTargets();
}

void TreeStage::makeTargets() {
    const auto pixels = static_cast<GLsizei>(mView.size.x);
    mGl.CreateFramebuffers(1, &mFramebuffer);
    mGl.CreateTextures(GL_TEXTURE_2D, 1, &mDepth);
    mGl.TextureStorage2D(mDepth, 1, GL_DEPTH_COMPONENT32F, pixels, pixels);
    mGl.NamedFramebufferTexture(mFramebuffer, GL_DEPTH_ATTACHMENT, mDepth, 0);
    mGl.CreateTextures(GL_TEXTURE_2D, 3, mTargets.data());
    constexpr GLenum kOutputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                   GL_COLOR_ATTACHMENT2};
    for (std::size_t i = 0; i < mTargets.size(); ++i) {
        mGl.TextureStorage2D(mTargets[i], 1, GL_RGBA32F, pixels, pixels);
        mGl.NamedFramebufferTexture(mFramebuffer, kOutputs[i], mTargets[i], 0);
    }
    mGl.NamedFramebufferDrawBuffers(mFramebuffer, 3, kOutputs);
}

std::vector<glm::vec4> TreeStage::read(GLuint texture) const {
    std::vector<glm::vec4> pixels(std::size_t{mView.size.x} * mView.size.y);
    mGl.GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT,
                        static_cast<GLsizei>(pixels.size() * sizeof(glm::vec4)), pixels.data());
    return pixels;
}

void TreeStage::drawMesh(const EngineMesh& mesh, const glm::vec4& albedo) const {
    mGl.ProgramUniform4fv(mProgram, 1, 1, glm::value_ptr(albedo));
    example::draw(mGl, mesh);
}

TreeStage::Pixels TreeStage::draw(bool inColors) const {
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer);
    mGl.Viewport(0, 0, static_cast<GLsizei>(mView.size.x), static_cast<GLsizei>(mView.size.y));
    mGl.Enable(GL_DEPTH_TEST);
    constexpr float kNone[] = {0.0f, 0.0f, 0.0f, 0.0f};
    constexpr float kFarthest = 1.0f;
    for (int i = 0; i < 3; ++i)
        mGl.ClearNamedFramebufferfv(mFramebuffer, GL_COLOR, i, kNone);
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_DEPTH, 0, &kFarthest);
    mGl.UseProgram(mProgram);
    const glm::mat4 camera(mView.worldToClip);
    mGl.ProgramUniformMatrix4fv(mProgram, 0, 1, GL_FALSE, glm::value_ptr(camera));
    drawMesh(mGround, {0.55f, 0.52f, 0.46f, 0.0f});
    drawMesh(mWood, {0.24f, 0.17f, 0.12f, 0.0f});
    for (std::size_t i = 0; i < kLeafClasses; ++i)
        drawMesh(mLeaves[i], glm::vec4(kLeafColors[inColors ? i : 0], 1.0f));
    return {read(mTargets[0]), read(mTargets[1]), read(mTargets[2])};
}

} // namespace example
