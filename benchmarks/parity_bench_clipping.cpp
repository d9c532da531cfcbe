#include "parity_bench.hpp"

#include "gl/device_state.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace lamina::bench {
namespace {

/// What a frame's fragments pay for.
enum class Clip {
    None,
    Discard, ///< A `discard` that never happens.
    Place,   ///< The point's place in each sprite and the test of its box, and an idle `discard`.
    Parity,  ///< The parity test.
    Sorted,  ///< Only where a surface may cross the triangle; a compute pass decides every frame.
    Kept,    ///< As it was sorted last: scene and volumes rest, the camera may move.
};
constexpr std::array<Clip, 6> kClips = {Clip::None,   Clip::Discard, Clip::Place,
                                        Clip::Parity, Clip::Sorted,  Clip::Kept};
constexpr std::size_t kFragmentPrograms = 4;

/// A frame of a lit mesh, clipped by the sprites of a set or not.
class ClipFrame {
public:
    /// lights: point lights of its shading.
    ClipFrame(const Device& device, const TriangleMesh& mesh, int lights, GLsizei width,
              GLsizei height);
    ~ClipFrame();
    ClipFrame(const ClipFrame&) = delete;
    ClipFrame& operator=(const ClipFrame&) = delete;

    void draw(Clip clip) const;
    /// Of the picture that was drawn last.
    [[nodiscard]] std::vector<std::uint8_t> pixels() const;

private:
    void sort() const;

    const GladGLContext& mGl;
    std::array<GLuint, kFragmentPrograms> mPrograms{};
    GLuint mSorter = 0;
    GLuint mFramebuffer = 0, mColor = 0, mDepth = 0, mVertexArray = 0;
    /// Indices of what is drawn without and with the test, and the two draws.
    std::array<GLuint, 2> mSorted{};
    GLuint mCommands = 0;
    MeshBuffers mBuffers;
    GLsizei mIndexCount;
    GLsizei mWidth, mHeight;
};

using Stages = std::initializer_list<std::pair<GLenum, std::string>>;

GLuint makeProgram(const GladGLContext& gl, const Stages& stages) {
    const GLuint program = gl.CreateProgram();
    for (const auto& [stage, source] : stages) {
        const GLuint shader = gl.CreateShader(stage);
        const char* text = source.c_str();
        gl.ShaderSource(shader, 1, &text, nullptr);
        gl.CompileShader(shader);
        gl.AttachShader(program, shader);
        gl.DeleteShader(shader);
    }
    gl.LinkProgram(program);
    GLint linked = GL_FALSE;
    gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        std::fprintf(stderr, "lamina_parity_bench: the frame's program does not link\n");
        std::exit(1);
    }
    return program;
}

constexpr const char* kVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 worldToClip;
layout(location = 0) out vec3 world;
void main() {
    world = position;
    gl_Position = worldToClip * vec4(position, 1.0);
})";

/// LIGHTS point lights with a glossy term each, on the faces' own normals.
constexpr const char* kFragment = R"(
layout(location = 0) in vec3 world;
layout(location = 0) out vec4 color;
void main() {
#if CLIP == 1
    if (world.x < -100.0) // never
        discard;
#elif CLIP == 2
    float depths = 0.0;
    for (int sprite = 0; sprite < 2; ++sprite) {
        vec3 place = laminaParityPlace(sprite, world);
        depths += laminaParityHolds(sprite, place) ? place.z : 0.0;
    }
    if (depths == 7.0) // never
        discard;
#elif CLIP == 3
    if (laminaParityCombine(laminaParityMask(world), LAMINA_PARITY_UNION))
        discard;
#endif
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    vec3 view = normalize(vec3(0.0, 0.0, 4.0) - world);
    vec3 sum = vec3(0.05);
    for (int i = 0; i < LIGHTS; ++i) {
        float angle = float(i) * 0.7;
        vec3 toLight = vec3(3.0 * cos(angle), 3.0 * sin(angle), 2.0) - world;
        float fall = 8.0 / (float(LIGHTS) * dot(toLight, toLight));
        vec3 light = normalize(toLight);
        float gloss = pow(max(dot(normal, normalize(light + view)), 0.0), 40.0);
        sum += fall * (max(dot(normal, light), 0.0) * vec3(0.8, 0.7, 0.6) + gloss);
    }
    color = vec4(sum, 1.0);
})";

// One invocation owns a triangle: it joins those drawn without the test, those with, or none. Each
// list counts its indices in its draw. Atomic: any triangle may be the next.
constexpr const char* kSorter = R"(
layout(local_size_x = 64) in;
struct Draw { uint count, instances, first; int base; uint firstInstance, pad[3]; };
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Indices { uint indices[]; };
layout(std430, binding = 2) buffer Draws { Draw draws[2]; };
layout(std430, binding = 3) writeonly buffer Certain { uint certain[]; };
layout(std430, binding = 4) writeonly buffer Tested { uint tested[]; };
vec3 corner(uint vertex) {
    return vec3(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}
void main() {
    uint first = 3u * gl_GlobalInvocationID.x;
    if (first >= uint(indices.length()))
        return;
    uvec3 triangle = uvec3(indices[first], indices[first + 1u], indices[first + 2u]);
    int answer = laminaParityTriangleCombined(corner(triangle.x), corner(triangle.y), corner(triangle.z),
                                             LAMINA_PARITY_UNION);
    if (answer == LAMINA_PARITY_OUTSIDE) {
        uint place = atomicAdd(draws[0].count, 3u);
        for (uint i = 0u; i < 3u; ++i)
            certain[place + i] = triangle[i];
    } else if (answer == LAMINA_PARITY_BORDER) {
        uint place = atomicAdd(draws[1].count, 3u);
        for (uint i = 0u; i < 3u; ++i)
            tested[place + i] = triangle[i];
    }
})";
constexpr GLsizeiptr kDrawBytes = 32;
constexpr GLsizei kSorterGroup = 64;

ClipFrame::ClipFrame(const Device& device, const TriangleMesh& mesh, int lights, GLsizei width,
                     GLsizei height)
    : mGl(device.state()->gl)
    , mBuffers(need(MeshBuffers::upload(device, mesh)))
    , mIndexCount(static_cast<GLsizei>(3 * mesh.triangles.size()))
    , mWidth(width)
    , mHeight(height) {
    const std::string head = "#version 450 core\n#define LAMINA_PARITY_COUNT 2\n";
    const std::string parity = need(shaderSource("lamina/parity.glsl"));
    const glm::mat4 matrix =
        glm::perspective(0.6f, static_cast<float>(width) / static_cast<float>(height), 0.5f,
                         10.0f) *
        glm::lookAt(glm::vec3(0, 0, 4), glm::vec3(0), glm::vec3(0, 1, 0));
    for (std::size_t i = 0; i < mPrograms.size(); ++i) {
        const std::string settings = "#define CLIP " + std::to_string(i) + "\n#define LIGHTS " +
                                     std::to_string(lights) + "\n";
        const bool asks = kClips[i] == Clip::Place || kClips[i] == Clip::Parity;
        mPrograms[i] = makeProgram(
            mGl, {{GL_VERTEX_SHADER, kVertex},
                  {GL_FRAGMENT_SHADER, head + settings + (asks ? parity : "") + kFragment}});
        mGl.ProgramUniformMatrix4fv(mPrograms[i], 0, 1, GL_FALSE, glm::value_ptr(matrix));
    }
    mSorter = makeProgram(mGl, {{GL_COMPUTE_SHADER,
                                 head + need(shaderSource("lamina/parity_boxes.glsl")) + kSorter}});
    mGl.CreateFramebuffers(1, &mFramebuffer);
    mGl.CreateRenderbuffers(1, &mColor);
    mGl.CreateRenderbuffers(1, &mDepth);
    mGl.NamedRenderbufferStorage(mColor, GL_RGBA8, mWidth, mHeight);
    mGl.NamedRenderbufferStorage(mDepth, GL_DEPTH_COMPONENT32F, mWidth, mHeight);
    mGl.NamedFramebufferRenderbuffer(mFramebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, mColor);
    mGl.NamedFramebufferRenderbuffer(mFramebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, mDepth);
    mGl.CreateVertexArrays(1, &mVertexArray);
    mGl.EnableVertexArrayAttrib(mVertexArray, 0);
    mGl.VertexArrayAttribFormat(mVertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    mGl.VertexArrayVertexBuffer(mVertexArray, 0, mBuffers.view().vertexBuffer, 0, 12);
    mGl.CreateBuffers(2, mSorted.data());
    for (const GLuint buffer : mSorted)
        mGl.NamedBufferStorage(buffer, 4 * GLsizeiptr{mIndexCount}, nullptr, 0);
    mGl.CreateBuffers(1, &mCommands);
    mGl.NamedBufferStorage(mCommands, 2 * kDrawBytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
}

ClipFrame::~ClipFrame() {
    for (const GLuint program : mPrograms)
        mGl.DeleteProgram(program);
    mGl.DeleteProgram(mSorter);
    mGl.DeleteFramebuffers(1, &mFramebuffer);
    mGl.DeleteRenderbuffers(1, &mColor);
    mGl.DeleteRenderbuffers(1, &mDepth);
    mGl.DeleteVertexArrays(1, &mVertexArray);
    mGl.DeleteBuffers(2, mSorted.data());
    mGl.DeleteBuffers(1, &mCommands);
}

void ClipFrame::sort() const {
    constexpr std::array<GLuint, 16> kNothing = {0, 1, 0, 0, 0, 0, 0, 0, 0, 1};
    mGl.NamedBufferSubData(mCommands, 0, sizeof kNothing, kNothing.data());
    const MeshView view = mBuffers.view();
    const std::array<GLuint, 5> buffers = {view.vertexBuffer, view.indexBuffer, mCommands,
                                           mSorted[0], mSorted[1]};
    mGl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, 5, buffers.data());
    mGl.UseProgram(mSorter);
    const GLsizei triangles = mIndexCount / 3;
    mGl.DispatchCompute(static_cast<GLuint>((triangles + kSorterGroup - 1) / kSorterGroup), 1, 1);
    mGl.MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT);
}

void ClipFrame::draw(Clip clip) const {
    constexpr GLfloat kBlack[] = {0, 0, 0, 1};
    constexpr GLfloat kFar = 1.0f;
    mGl.BindFramebuffer(GL_FRAMEBUFFER, mFramebuffer);
    mGl.Viewport(0, 0, mWidth, mHeight);
    mGl.Enable(GL_DEPTH_TEST);
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_COLOR, 0, kBlack);
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_DEPTH, 0, &kFar);
    mGl.BindVertexArray(mVertexArray);
    if (clip == Clip::Sorted)
        sort();
    if (clip == Clip::Sorted || clip == Clip::Kept) {
        mGl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, mCommands);
        for (std::size_t i = 0; i < 2; ++i) {
            mGl.UseProgram(mPrograms[static_cast<std::size_t>(i == 0 ? Clip::None : Clip::Parity)]);
            mGl.VertexArrayElementBuffer(mVertexArray, mSorted[i]);
            mGl.DrawElementsIndirect(
                GL_TRIANGLES, GL_UNSIGNED_INT,
                reinterpret_cast<const void*>(static_cast<std::size_t>(kDrawBytes) * i));
        }
    } else {
        mGl.UseProgram(mPrograms[static_cast<std::size_t>(clip)]);
        mGl.VertexArrayElementBuffer(mVertexArray, mBuffers.view().indexBuffer);
        mGl.DrawElements(GL_TRIANGLES, mIndexCount, GL_UNSIGNED_INT, nullptr);
    }
    mGl.Finish();
    mGl.Disable(GL_DEPTH_TEST);
}

std::vector<std::uint8_t> ClipFrame::pixels() const {
    std::vector<std::uint8_t> bytes(std::size_t{4} * static_cast<std::size_t>(mWidth * mHeight));
    mGl.BindFramebuffer(GL_READ_FRAMEBUFFER, mFramebuffer);
    mGl.ReadPixels(0, 0, mWidth, mHeight, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
    return bytes;
}

/// Two clip volumes that have `layers` layers together; the first has the odd shell.
std::vector<TriangleMesh> clipVolumes(unsigned layers) {
    std::vector<TriangleMesh> volumes;
    const unsigned shells = layers / 2;
    for (const unsigned count : {(shells + 1) / 2, shells / 2}) {
        std::vector<float> radii;
        for (unsigned i = 0; i < count; ++i)
            radii.push_back(0.5f * (1.0f - static_cast<float>(i) / static_cast<float>(count)));
        const float x = volumes.empty() ? -0.35f : 0.35f;
        volumes.push_back(reference::makeNestedShells({x, 0.1f, 0.3f}, radii, 3));
    }
    return volumes;
}

/// Pixels of a picture that differ from another's.
std::size_t differences(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); i += 4)
        count += std::equal(a.begin() + static_cast<std::ptrdiff_t>(i),
                            a.begin() + static_cast<std::ptrdiff_t>(i) + 4,
                            b.begin() + static_cast<std::ptrdiff_t>(i))
                     ? 0
                     : 1;
    return count;
}

/// Two sprites of clip volumes with `samples` layers together.
std::vector<DepthSprite> clipSprites(const Device& device, unsigned samples,
                                     std::uint32_t columns) {
    auto builder = need(SpriteBuilder::create(device));
    std::vector<DepthSprite> sprites;
    for (const TriangleMesh& volume : clipVolumes(samples)) {
        auto buffers = need(MeshBuffers::upload(device, volume));
        const GeometrySource source = buffers.view();
        sprites.push_back(need(DepthSprite::create(device)));
        need(builder.buildAndWait(
            {&source, 1}, need(fitSprite(volume.bounds(), {0, 0, 1}, columns)), sprites.back()));
    }
    return sprites;
}

void printRow(const ClipFrame& frame, int rounds) {
    std::array<std::function<void()>, kClips.size()> frames;
    for (std::size_t i = 0; i < kClips.size(); ++i)
        frames[i] = [&frame, i] { frame.draw(kClips[i]); };
    const auto times = measure<kClips.size()>(frames, rounds);
    std::printf(" | %7.1f ms", times[0].processor);
    for (std::size_t i = 1; i < times.size(); ++i)
        std::printf(" %8.2f", times[i].processor / times[0].processor);
    frame.draw(Clip::Parity);
    const auto tested = frame.pixels();
    frame.draw(Clip::Sorted);
    std::printf(" | %zu\n", differences(tested, frame.pixels()));
}

} // namespace

void printClipping(const Device& device, const Shape& shape, int rounds) {
    constexpr GLsizei kWidth = 1280;
    constexpr GLsizei kHeight = 960;
    std::printf("\nClipping \"%s\" (%zu triangles) by two sprites, %d x %d pixels, processor time, "
                "median of %d. Ratios to the frame without:\n  a discard that never happens; also "
                "the points' places and boxes; the test; the test only for triangles that a\n  "
                "surface may cross, sorted every frame (lamina/parity_boxes.glsl); sorted before\n"
                "%-6s %7s %7s | %10s %8s %8s %8s %8s %8s | %s\n",
                shape.name.c_str(), shape.mesh.triangles.size(), kWidth, kHeight, rounds, "lights",
                "columns", "samples", "without", "discard", "places", "test", "sorted", "before",
                "pixels that sorting changes");
    // Into [-1,1].
    TriangleMesh mesh = shape.mesh;
    const Box3 box = mesh.bounds();
    const double scale = 2.0 / std::max({box.size().x, box.size().y, box.size().z});
    for (glm::vec3& p : mesh.positions)
        p = glm::vec3((glm::dvec3(p) - box.center()) * scale);
    auto set = need(SpriteSet::create(device));
    for (const int lights : {1, 8}) {
        const ClipFrame frame(device, mesh, lights, kWidth, kHeight);
        for (const std::uint32_t columns : {1024u, 256u})
            for (const unsigned samples : {10u, 80u}) {
                const auto sprites = clipSprites(device, samples, columns);
                const SpriteInstance instances[] = {{.sprite = &sprites[0]},
                                                    {.sprite = &sprites[1]}};
                need(set.update(instances));
                set.bind();
                std::printf("%-6d %7u %7u", lights, columns,
                            sprites[0].layers() + sprites[1].layers());
                printRow(frame, rounds);
            }
    }
}

} // namespace lamina::bench
