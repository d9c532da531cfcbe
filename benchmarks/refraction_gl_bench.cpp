// Stages of refraction at 512 x 512 pixels: thickness maps by arithmetic and by table, volumes, and
// the shading of a sphere-like G-buffer by each model.

#include "bench_case.hpp"
#include "gl_timing.hpp"
#include "uploaded_mesh.hpp"

#include "gl/device_state.hpp"
#include "gl/objects.hpp"

#include <lamina/refraction/refraction.hpp>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <optional>

namespace lamina::bench {
namespace {

constexpr std::uint32_t kPixels = 512;

View viewOf(const Box3& bounds) {
    const double radius = 0.5 * glm::length(bounds.size());
    View view;
    view.size = glm::uvec2(kPixels);
    view.worldToClip = glm::perspective(0.8, 1.0, 0.1 * radius, 10.0 * radius) *
                       glm::lookAt(bounds.center() + radius * glm::dvec3(1.0, 0.8, 2.2),
                                   bounds.center(), glm::dvec3(0, 1, 0));
    return view;
}

Result<void> runThickness(benchmark::State& state, const Device& device, NamedMesh& named,
                          const ThicknessDesc& desc) {
    auto uploaded = upload(device, named);
    if (!uploaded)
        return uploaded.error();
    auto map = ThicknessMap::create(device, desc);
    if (!map)
        return map.error();
    const Box3 bounds = uploaded->mesh->bounds();
    const View view = viewOf(bounds);
    return measure(state, device, [&]() -> Result<void> {
        const auto built = map->build({&uploaded->source, 1}, view, bounds);
        return built ? Result<void>{} : built.error();
    });
}

/// The G-buffer of a ball that fills most of the picture, made on the host.
struct BallBuffer {
    gl::Texture depth, normals;

    BallBuffer(const Device& device, const View& view, const Box3& bounds)
        : depth(gl::Texture::create(device.state(), "bench", GL_TEXTURE_2D))
        , normals(gl::Texture::create(device.state(), "bench", GL_TEXTURE_2D)) {
        std::vector<float> depths(std::size_t{kPixels} * kPixels, 1.0f);
        std::vector<glm::vec4> facings(depths.size(), glm::vec4(0.0f));
        const glm::dmat4 inverse = glm::inverse(view.worldToClip);
        const glm::dvec3 eye(glm::dvec3(*viewpoint(view)));
        const double radius = 0.3 * glm::length(bounds.size());
        for (std::uint32_t y = 0; y < kPixels; ++y)
            for (std::uint32_t x = 0; x < kPixels; ++x) {
                const glm::dvec4 far =
                    inverse * glm::dvec4((x + 0.5) / kPixels * 2.0 - 1.0,
                                         (y + 0.5) / kPixels * 2.0 - 1.0, 0.5, 1.0);
                const glm::dvec3 ray = glm::normalize(glm::dvec3(far) / far.w - eye);
                const glm::dvec3 offset = eye - bounds.center();
                const double b = glm::dot(offset, ray);
                const double root = b * b - glm::dot(offset, offset) + radius * radius;
                if (root < 0.0)
                    continue;
                const glm::dvec3 point = eye + (-b - std::sqrt(root)) * ray;
                const glm::dvec4 clip = view.worldToClip * glm::dvec4(point, 1.0);
                const std::size_t i = std::size_t{y} * kPixels + x;
                depths[i] = static_cast<float>(clip.z / clip.w * 0.5 + 0.5);
                facings[i] = glm::vec4((point - bounds.center()) / radius, 0.0);
            }
        const GladGLContext& gl = device.state()->gl;
        gl.TextureStorage2D(depth.id(), 1, GL_R32F, kPixels, kPixels);
        gl.TextureStorage2D(normals.id(), 1, GL_RGBA16F, kPixels, kPixels);
        gl.TextureSubImage2D(depth.id(), 0, 0, 0, kPixels, kPixels, GL_RED, GL_FLOAT,
                             depths.data());
        gl.TextureSubImage2D(normals.id(), 0, 0, 0, kPixels, kPixels, GL_RGBA, GL_FLOAT,
                             facings.data());
    }
};

enum class Stage { Prepare, Apply };

Result<void> runRefraction(benchmark::State& state, const Device& device, NamedMesh& named,
                           RefractionModel model, Stage stage) {
    auto uploaded = upload(device, named);
    if (!uploaded)
        return uploaded.error();
    RefractionDesc desc;
    desc.model = model;
    auto refraction = Refraction::create(device, desc);
    if (!refraction)
        return refraction.error();
    auto environment = Environment::create(device, {.size = 64});
    if (!environment)
        return environment.error();
    refraction->setEnvironment(*environment);
    Material glass;
    glass.refractiveIndex = 1.5f;
    const RefractionObject object{{&uploaded->source, 1}, {&glass, 1}, uploaded->mesh->bounds()};
    const View view = viewOf(object.bounds);
    const auto prepare = [&]() -> Result<void> {
        const auto prepared = refraction->prepare(object, view);
        return prepared ? Result<void>{} : prepared.error();
    };
    if (stage == Stage::Prepare)
        return measure(state, device, prepare);
    if (auto prepared = prepare(); !prepared)
        return prepared;
    const BallBuffer ball(device, view, object.bounds);
    RefractionReceiver receiver;
    receiver.view = view;
    receiver.depthTexture = ball.depth.id();
    receiver.normalTexture = ball.normals.id();
    return measure(state, device, [&]() -> Result<void> {
        const auto applied = refraction->apply(receiver);
        return applied ? Result<void>{} : applied.error();
    });
}

} // namespace

void registerRefraction(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    const std::string name = mesh->name + "/512/lamina ";
    for (const std::uint32_t slices : {32u, 128u, 1024u})
        for (const auto method : {IntegralMethod::Arithmetic, IntegralMethod::Table})
            registerMethod(name + "thickness " + std::to_string(slices) +
                               (method == IntegralMethod::Table ? " by table" : " by arithmetic"),
                           [=, &device](benchmark::State& state) {
                               return runThickness(state, device, *mesh, {slices, method});
                           });
    struct Row {
        const char* name;
        RefractionModel model;
        Stage stage;
    };
    for (const Row& row :
         {Row{"refraction volume 128", RefractionModel::ManySurfaces, Stage::Prepare},
          Row{"refraction integral", RefractionModel::VolumeIntegral, Stage::Apply},
          Row{"refraction two surfaces", RefractionModel::TwoSurfaces, Stage::Apply},
          Row{"refraction many surfaces", RefractionModel::ManySurfaces, Stage::Apply}})
        registerMethod(name + row.name, [=, &device](benchmark::State& state) {
            return runRefraction(state, device, *mesh, row.model, row.stage);
        });
}

} // namespace lamina::bench
