#include "area_light/point_samples.hpp"

#include "area_light/imperfect_constants.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/mesh_view.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace lamina {
namespace {

constexpr const char* kOperation = "area light point samples";
constexpr const char* kSource = "area light: source";
constexpr std::uint64_t kTriangleBytes = 9 * sizeof(float);
constexpr std::uint32_t kPointsPerGroup = 64;

Result<GLuint> computeProgram(gl::DeviceState& device, const char* shader) {
    return gl::findOrBuildProgram(device,
                                  {"lamina point samples", {{GL_COMPUTE_SHADER, shader}}, {}});
}

/// Most triangles that a source can have.
std::uint64_t mostTriangles(const GeometrySource& source, const CapturedTriangles& captured) {
    if (const auto* view = std::get_if<MeshView>(&source))
        return triangleCount(*view);
    return captured.capacity;
}

std::uint64_t blocksOf(std::uint64_t triangles) {
    return (triangles + LAMINA_SAMPLE_BLOCK_TRIANGLES - 1) / LAMINA_SAMPLE_BLOCK_TRIANGLES;
}

} // namespace

PointSamples::PointSamples(std::shared_ptr<gl::DeviceState> device, std::uint32_t points)
    : mDevice(std::move(device))
    , mCount(points)
    , mCapture(mDevice, CaptureContent::Positions)
    , mConstants(gl::Buffer::create(mDevice, "lamina point sample pass")) {}

Result<PointSamples> PointSamples::create(std::shared_ptr<gl::DeviceState> device,
                                          std::uint32_t points) {
    PointSamples made(std::move(device), points);
    const std::pair<const char*, GLuint*> programs[] = {
        {"area_light/sample_weights.comp", &made.mWeighProgram},
        {"area_light/sample_blocks.comp", &made.mSumProgram},
        {"area_light/sample_points.comp", &made.mPointProgram}};
    for (const auto& [shader, program] : programs) {
        const auto built = computeProgram(*made.mDevice, shader);
        if (!built)
            return built.error();
        *program = *built;
    }
    return made;
}

Result<void> PointSamples::reserve(std::uint64_t blocks) {
    const auto grow = [&](gl::Buffer& buffer, std::uint64_t bytes,
                          const char* label) -> Result<void> {
        if (bytes <= buffer.bytes())
            return {};
        if (bytes > mDevice->limits.maxStorageBlockBytes)
            return Error{ErrorCode::DeviceLimit,
                         std::string(kOperation) + ": expected at most " +
                             std::to_string(mDevice->limits.maxStorageBlockBytes) +
                             " bytes of triangles or points, the device's limit, found " +
                             std::to_string(bytes) + "; use rendered maps, or less geometry"};
        auto made = gl::createBuffer(mDevice, bytes, nullptr, 0, kOperation, label);
        if (!made)
            return made.error();
        buffer = std::move(*made);
        return {};
    };
    const std::uint64_t triangles = blocks * LAMINA_SAMPLE_BLOCK_TRIANGLES;
    if (auto done = grow(mTriangles, triangles * kTriangleBytes, "lamina sampled triangles"); !done)
        return done;
    if (auto done = grow(mWeights, triangles * sizeof(float), "lamina sample weights"); !done)
        return done;
    if (auto done = grow(mBlocks, blocks * sizeof(float), "lamina sample blocks"); !done)
        return done;
    return grow(mPoints, mCount * sizeof(shared::LaminaPointSample), "lamina point samples");
}

void PointSamples::dispatch(GLuint program, const void* constants, GLuint captured,
                            std::uint32_t groups) {
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 1, LAMINA_SAMPLE_BINDING_COUNT);
    gl.NamedBufferData(mConstants.id(), sizeof(shared::LaminaSampleConstants), constants,
                       GL_STREAM_DRAW);
    const GLuint uniforms = mConstants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_SAMPLE_UNIFORM_BINDING, 1, &uniforms);
    const GLuint buffers[LAMINA_SAMPLE_BINDING_COUNT] = {captured, mTriangles.id(), mWeights.id(),
                                                         mBlocks.id(), mPoints.id()};
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, LAMINA_SAMPLE_BINDING_COUNT, buffers);
    gl.UseProgram(program);
    gl.DispatchCompute(groups, 1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

Result<void> PointSamples::prepare(std::span<const GeometrySource> sources) {
    if (auto sound = mCapture.checkHost(); !sound)
        return sound;
    mCapturePrograms.clear();
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&sources[i]);
        auto sound = view ? checkMeshView(*mDevice, *view, i, kSource)
                          : checkDrawSource(std::get<DrawSource>(sources[i]), i, kSource);
        if (!sound)
            return sound;
        const auto program =
            view ? mCapture.meshProgram() : mCapture.program(std::get<DrawSource>(sources[i]));
        if (!program)
            return program.error();
        mCapturePrograms.push_back(*program);
    }
    std::uint64_t blocks = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&sources[i]);
        const std::uint64_t triangles =
            view ? triangleCount(*view) : std::get<DrawSource>(sources[i]).maxTriangles;
        blocks += blocksOf(triangles);
        if (auto room = mCapture.reserve(i, triangles); !room)
            return room;
    }
    // Nothing to sample: one block without weight.
    return reserve(std::max<std::uint64_t>(blocks, 1));
}

Result<void> PointSamples::draw(std::span<const GeometrySource> sources, const glm::dvec3& middle,
                                double near) {
    const gl::DebugGroup group(*mDevice, "lamina: point samples");
    std::vector<CapturedTriangles> captured;
    std::uint64_t blocks = 0;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&sources[i]);
        if (view && triangleCount(*view) == 0) {
            captured.push_back({});
            continue;
        }
        const GLuint program = mCapturePrograms[i];
        auto triangles = view ? mCapture.capture(i, *view, program)
                              : mCapture.capture(i, std::get<DrawSource>(sources[i]), program);
        if (!triangles)
            return triangles.error();
        captured.push_back(*triangles);
        blocks += blocksOf(mostTriangles(sources[i], *triangles));
    }
    if (auto room = reserve(std::max<std::uint64_t>(blocks, 1)); !room)
        return room;

    mDevice->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    shared::LaminaSampleConstants constants{};
    constants.light = glm::vec4(glm::vec3(middle), static_cast<float>(near));
    std::uint64_t first = 0;
    const auto weigh = [&](const CapturedTriangles& triangles, std::uint64_t count,
                           const glm::mat4& toWorld) {
        const std::uint64_t own = std::max<std::uint64_t>(blocksOf(count), 1);
        constants.toWorld = toWorld;
        constants.counts = {count, first, 0, 0};
        dispatch(mWeighProgram, &constants, triangles.buffer, static_cast<std::uint32_t>(own));
        first += own;
    };
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const auto* view = std::get_if<MeshView>(&sources[i]);
        if (captured[i].buffer != 0)
            weigh(captured[i], mostTriangles(sources[i], captured[i]),
                  view ? view->model : glm::mat4(1.0f));
    }
    if (first == 0)
        weigh({mTriangles.id(), CaptureContent::Positions, 0}, 0, glm::mat4(1.0f));
    constants.counts = {0, 0, first, mCount};
    dispatch(mSumProgram, &constants, 0, 1);
    dispatch(mPointProgram, &constants, 0, (mCount + kPointsPerGroup - 1) / kPointsPerGroup);
    return {};
}

} // namespace lamina
