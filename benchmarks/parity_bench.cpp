// lamina_parity_bench: the figures of depth sprites, each table measured in one run.
//   1. building: single pass against depth peeling;
//   2. accuracy: share of wrong points by columns, one direction and three;
//   3. clipping: a frame clipped by two sprites against the same frame without ([TD08] Table 1).
#include "bench_case.hpp"

#include "gl/device_state.hpp"

#include <lamina/gl/shaders.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/parity/point_classifier.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <reference/point_parity.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string_view>

namespace lamina::bench {
namespace {

template<class T>
T need(Result<T> result) {
    if (result)
        return std::move(*result);
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
    std::exit(1);
}

void need(Result<void> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().text.c_str());
        std::exit(1);
    }
}

/// Median milliseconds of a call: wall, and of all threads.
struct Time {
    double wall = 0.0;
    double processor = 0.0;
};

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// Runs the calls in turn, so that what else the machine does hits all of them alike.
template<std::size_t count>
std::array<Time, count> measure(const std::array<std::function<void()>, count>& calls, int rounds) {
    std::array<std::vector<double>, count> walls;
    std::array<std::vector<double>, count> processors;
    for (int round = -1; round < rounds; ++round)
        for (std::size_t i = 0; i < count; ++i) {
            const auto start = std::chrono::steady_clock::now();
            const std::clock_t clock = std::clock();
            calls[i]();
            if (round < 0)
                continue; // compiles programs
            const std::chrono::duration<double, std::milli> wall =
                std::chrono::steady_clock::now() - start;
            walls[i].push_back(wall.count());
            processors[i].push_back(1e3 * static_cast<double>(std::clock() - clock) /
                                    CLOCKS_PER_SEC);
        }
    std::array<Time, count> times;
    for (std::size_t i = 0; i < count; ++i)
        times[i] = {median(walls[i]), median(processors[i])};
    return times;
}

struct Shape {
    std::string name;
    TriangleMesh mesh;
};

std::vector<Shape> shapes() {
    const float radii[] = {1.0f, 0.8f, 0.5f, 0.3f};
    std::vector<Shape> all = {
        {"torus knot", reference::makeTorusKnot({}, 0.55f, 0.12f, 2, 3, 512, 32)},
        {"menger sponge", reference::makeMengerSponge({0.01f, 0.02f, 0.03f}, 1.8f, 3)},
        {"nested shells", reference::makeNestedShells({}, radii, 4)},
    };
    for (const auto& mesh : benchMeshes())
        if (mesh->name == "glmark2_bunny" || mesh->name == "armadillo")
            all.push_back({mesh->name, *need(mesh->get())});
    return all;
}

void printBuilding(const Device& device, std::span<const Shape> meshes, int rounds) {
    const GladGLContext& gl = device.state()->gl;
    std::printf("\nBuilding, median of %d\n%-16s %9s %8s %7s | %-19s | %-19s | %s\n", rounds,
                "shape", "triangles", "columns", "layers", "single pass: wall, CPU",
                "peeling: wall, CPU", "peeling / single pass (CPU)");
    auto builder = need(SpriteBuilder::create(device));
    for (const Shape& shape : meshes)
        for (const std::uint32_t columns : {256u, 512u, 1024u}) {
            const auto transform = need(fitSprite(shape.mesh.bounds(), {0, 0, 1}, columns));
            auto buffers = need(MeshBuffers::upload(device, shape.mesh));
            const GeometrySource source = buffers.view();
            auto sprite = need(DepthSprite::create(device));
            need(builder.buildAndWait({&source, 1}, transform, sprite));
            const auto build = [&](SpriteMethod method) {
                return [&, method] {
                    need(builder.build({&source, 1}, transform, sprite.layers(), sprite, method));
                    gl.Finish();
                };
            };
            const auto times =
                measure<2>({build(SpriteMethod::SinglePass), build(SpriteMethod::Peeling)}, rounds);
            std::printf("%-16s %9zu %8u %7u | %9.1f %9.1f ms | %9.1f %9.1f ms | %.2f\n",
                        shape.name.c_str(), shape.mesh.triangles.size(), columns, sprite.layers(),
                        times[0].wall, times[0].processor, times[1].wall, times[1].processor,
                        times[1].processor / times[0].processor);
        }
}

void printAccuracy(const Device& device, std::span<const Shape> meshes, std::size_t count) {
    std::printf("\nAccuracy: share of %zu random points of the bounds that differ from exact ray "
                "parity, by columns\n%-16s %-18s",
                count, "shape", "sprites");
    constexpr std::uint32_t kColumns[] = {128, 256, 512, 1024, 2048};
    for (const std::uint32_t columns : kColumns)
        std::printf(" %9u", columns);
    std::printf("\n");
    auto builder = need(SpriteBuilder::create(device));
    auto classifier = need(PointClassifier::create(device));
    auto set = need(SpriteSet::create(device));
    for (const Shape& shape : meshes) {
        const Box3 box = shape.mesh.bounds();
        std::mt19937 random(5);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        std::vector<glm::vec3> points(count);
        for (glm::vec3& point : points)
            point = glm::vec3(box.min +
                              glm::dvec3(unit(random), unit(random), unit(random)) * box.size());
        const auto expected = reference::pointParity(shape.mesh, points, Axis::X);
        auto buffers = need(MeshBuffers::upload(device, shape.mesh));
        const GeometrySource source = buffers.view();
        std::string rows[3];
        for (const std::uint32_t columns : kColumns) {
            std::vector<DepthSprite> sprites;
            for (const glm::dvec3& axis : {glm::dvec3(0, 0, 1), {1, 0, 0}, {0, 1, 0}}) {
                sprites.push_back(need(DepthSprite::create(device)));
                need(builder.buildAndWait({&source, 1}, need(fitSprite(box, axis, columns)),
                                          sprites.back()));
            }
            for (const std::uint32_t directions : {0u, 1u, 3u}) {
                std::vector<SpriteInstance> instances;
                for (std::size_t i = 0; i < std::max(directions, 1u); ++i)
                    instances.push_back({.sprite = &sprites[i]});
                need(set.update(instances));
                const auto answers =
                    need(classifier.download(set, points, {.directions = directions}));
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < count; ++i)
                    wrong += (answers[i] != 0) != (expected[i] != 0) ? 1 : 0;
                char text[32];
                std::snprintf(text, sizeof text, " %8.4f%%",
                              1e2 * static_cast<double>(wrong) / static_cast<double>(count));
                rows[std::min(directions, 2u)] += text;
            }
        }
        constexpr const char* kMethods[] = {"one", "one, interpolated", "three directions"};
        for (std::size_t i = 0; i < 3; ++i)
            std::printf("%-16s %-18s%s\n", i == 0 ? shape.name.c_str() : "", kMethods[i],
                        rows[i].c_str());
    }
}

/// A frame of a lit mesh, clipped by the sprites of a set or not.
class ClipFrame {
public:
    ClipFrame(const Device& device, const TriangleMesh& mesh, std::uint32_t width,
              std::uint32_t height);
    ~ClipFrame();
    ClipFrame(const ClipFrame&) = delete;
    ClipFrame& operator=(const ClipFrame&) = delete;

    /// How the frame's fragments are clipped: not at all, by a `discard` that never happens, by
    /// the parity test.
    enum Clip { None, Discard, Parity };
    void draw(Clip clip, bool lights) const;

private:
    const GladGLContext& mGl;
    std::array<GLuint, 6> mPrograms{};
    GLuint mFramebuffer = 0, mColor = 0, mDepth = 0, mVertexArray = 0;
    MeshBuffers mBuffers;
    GLsizei mIndexCount;
    GLsizei mWidth, mHeight;
};

GLuint makeProgram(const GladGLContext& gl, const std::string& vertex,
                   const std::string& fragment) {
    const GLuint program = gl.CreateProgram();
    for (const auto& [stage, source] :
         {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
        const GLuint shader = gl.CreateShader(static_cast<GLenum>(stage));
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

ClipFrame::ClipFrame(const Device& device, const TriangleMesh& mesh, std::uint32_t width,
                     std::uint32_t height)
    : mGl(device.state()->gl)
    , mBuffers(need(MeshBuffers::upload(device, mesh)))
    , mIndexCount(static_cast<GLsizei>(3 * mesh.triangles.size()))
    , mWidth(static_cast<GLsizei>(width))
    , mHeight(static_cast<GLsizei>(height)) {
    const std::string parity = need(shaderSource("lamina/parity.glsl"));
    for (std::size_t i = 0; i < mPrograms.size(); ++i) {
        const std::size_t clip = i % 3;
        const std::string head = "#version 450 core\n#define LAMINA_PARITY_COUNT 2\n#define CLIP " +
                                 std::to_string(clip) + "\n#define LIGHTS " +
                                 std::to_string(i < 3 ? 1 : 8) + "\n";
        mPrograms[i] = makeProgram(mGl, kVertex, head + (clip == Parity ? parity : "") + kFragment);
        const glm::mat4 matrix =
            glm::perspective(0.6f, static_cast<float>(width) / static_cast<float>(height), 0.5f,
                             10.0f) *
            glm::lookAt(glm::vec3(0, 0, 4), glm::vec3(0), glm::vec3(0, 1, 0));
        mGl.ProgramUniformMatrix4fv(mPrograms[i], 0, 1, GL_FALSE, glm::value_ptr(matrix));
    }
    mGl.CreateFramebuffers(1, &mFramebuffer);
    mGl.CreateRenderbuffers(1, &mColor);
    mGl.CreateRenderbuffers(1, &mDepth);
    mGl.NamedRenderbufferStorage(mColor, GL_RGBA8, mWidth, mHeight);
    mGl.NamedRenderbufferStorage(mDepth, GL_DEPTH_COMPONENT32F, mWidth, mHeight);
    mGl.NamedFramebufferRenderbuffer(mFramebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, mColor);
    mGl.NamedFramebufferRenderbuffer(mFramebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, mDepth);
    const MeshView view = mBuffers.view();
    mGl.CreateVertexArrays(1, &mVertexArray);
    mGl.EnableVertexArrayAttrib(mVertexArray, 0);
    mGl.VertexArrayAttribFormat(mVertexArray, 0, 3, GL_FLOAT, GL_FALSE, 0);
    mGl.VertexArrayVertexBuffer(mVertexArray, 0, view.vertexBuffer, 0, 12);
    mGl.VertexArrayElementBuffer(mVertexArray, view.indexBuffer);
}

ClipFrame::~ClipFrame() {
    for (const GLuint program : mPrograms)
        mGl.DeleteProgram(program);
    mGl.DeleteFramebuffers(1, &mFramebuffer);
    mGl.DeleteRenderbuffers(1, &mColor);
    mGl.DeleteRenderbuffers(1, &mDepth);
    mGl.DeleteVertexArrays(1, &mVertexArray);
}

void ClipFrame::draw(Clip clip, bool lights) const {
    constexpr GLfloat kBlack[] = {0, 0, 0, 1};
    constexpr GLfloat kFar = 1.0f;
    mGl.BindFramebuffer(GL_FRAMEBUFFER, mFramebuffer);
    mGl.Viewport(0, 0, mWidth, mHeight);
    mGl.Enable(GL_DEPTH_TEST);
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_COLOR, 0, kBlack);
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_DEPTH, 0, &kFar);
    mGl.UseProgram(mPrograms[(lights ? 3u : 0u) + clip]);
    mGl.BindVertexArray(mVertexArray);
    mGl.DrawElements(GL_TRIANGLES, mIndexCount, GL_UNSIGNED_INT, nullptr);
    mGl.Finish();
    mGl.Disable(GL_DEPTH_TEST);
}

/// Two clip volumes that have `layers` layers together.
std::vector<TriangleMesh> clipVolumes(unsigned layers) {
    std::vector<TriangleMesh> volumes;
    for (const float x : {-0.35f, 0.35f}) {
        std::vector<float> radii;
        for (unsigned i = 0; i < layers / 4; ++i)
            radii.push_back(0.5f * (1.0f - static_cast<float>(i) / static_cast<float>(layers / 4)));
        volumes.push_back(reference::makeNestedShells({x, 0.1f, 0.3f}, radii, 3));
    }
    return volumes;
}

void printClipping(const Device& device, const Shape& shape, int rounds) {
    std::printf("\nClipping \"%s\" (%zu triangles) by two sprites of 1024 columns, 1280 x 960 "
                "pixels, processor time, median of %d\n%-8s %8s | %12s %12s %12s | %s\n",
                shape.name.c_str(), shape.mesh.triangles.size(), rounds, "lights", "samples",
                "without", "idle discard", "with test", "ratios");
    // Into [-1,1].
    TriangleMesh mesh = shape.mesh;
    const Box3 box = mesh.bounds();
    const double scale = 2.0 / std::max({box.size().x, box.size().y, box.size().z});
    for (glm::vec3& p : mesh.positions)
        p = glm::vec3((glm::dvec3(p) - box.center()) * scale);
    const ClipFrame frame(device, mesh, 1280, 960);
    auto builder = need(SpriteBuilder::create(device));
    auto set = need(SpriteSet::create(device));
    for (const bool lights : {false, true})
        for (const unsigned samples : {8u, 80u}) {
            std::vector<DepthSprite> sprites;
            std::uint32_t layers = 0;
            for (const TriangleMesh& volume : clipVolumes(samples)) {
                auto buffers = need(MeshBuffers::upload(device, volume));
                const GeometrySource source = buffers.view();
                sprites.push_back(need(DepthSprite::create(device)));
                need(builder.buildAndWait({&source, 1},
                                          need(fitSprite(volume.bounds(), {0, 0, 1}, 1024)),
                                          sprites.back()));
                layers += sprites.back().layers();
            }
            const SpriteInstance instances[] = {{.sprite = &sprites[0]}, {.sprite = &sprites[1]}};
            need(set.update(instances));
            set.bind();
            const auto times = measure<3>({[&] { frame.draw(ClipFrame::None, lights); },
                                           [&] { frame.draw(ClipFrame::Discard, lights); },
                                           [&] { frame.draw(ClipFrame::Parity, lights); }},
                                          rounds);
            std::printf("%-8d %8u | %9.1f ms %9.1f ms %9.1f ms | %.2f %.2f\n", lights ? 8 : 1,
                        layers, times[0].processor, times[1].processor, times[2].processor,
                        times[1].processor / times[0].processor,
                        times[2].processor / times[0].processor);
        }
}

int run(std::string_view which, bool quick) {
    headless::ContextDesc desc;
    const auto context = need(headless::Context::create(desc));
    const Device device = need(
        Device::fromCurrentContext([&](const char* name) { return context.getProcAddress(name); }));
    std::printf("%s%s\n", device.info().renderer.c_str(),
                device.info().isSoftware ? " [software: runs on the CPU]" : "");
    std::vector<Shape> meshes = shapes();
    if (quick)
        meshes.resize(1);
    const int rounds = quick ? 1 : 5;
    if (which == "build" || which == "all")
        printBuilding(device, meshes, rounds);
    if (which == "accuracy" || which == "all")
        printAccuracy(device, meshes, quick ? 10000 : 1000000);
    if (which == "clip" || which == "all")
        printClipping(device, meshes.back(), rounds);
    return 0;
}

} // namespace
} // namespace lamina::bench

int main(int argc, char** argv) {
    std::string_view which = "all";
    bool quick = false;
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--quick")
            quick = true;
        else if (argument == "build" || argument == "accuracy" || argument == "clip" ||
                 argument == "all")
            which = argument;
        else {
            std::fputs("usage: lamina_parity_bench [all|build|accuracy|clip] [--quick]\n", stderr);
            return 2;
        }
    }
    return lamina::bench::run(which, quick);
}
