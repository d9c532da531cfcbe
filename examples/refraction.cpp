// Glass, jade and frosted bodies in an engine's frame ([ED06] 3.3, figure 11; [CLN11] 4, figures 3
// and 4). The engine draws what refracts into a G-buffer; Lamina shades those pixels.
//
//   refraction OUT.png [--picture materials|frosted|vase|nested|animated] [--mesh FILE] [--size N]

#include "support/check.hpp"
#include "support/refraction_stage.hpp"
#include "support/shapes.hpp"
#include "support/sky.hpp"
#include "support/vase.hpp"

#include <lamina/headless/context.hpp>
#include <lamina/mesh_io/mesh_file.hpp>
#include <lamina/refraction/refraction.hpp>

#include <CLI/CLI.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <cmath>
#include <cstring>

namespace {

using example::check;
using example::EngineMesh;
using example::HostGl;
using example::Stage;
using lamina::RefractionModel;

constexpr double kGlass = 1.5;

struct Settings {
    std::string file, picture = "materials", mesh;
    std::uint32_t size = 360;   ///< Pixels, the height of a picture.
    std::uint32_t voxels = 192; ///< A side of volumes.
};

/// Who makes a picture: the engine's GL, Lamina and the surroundings.
struct Studio {
    const HostGl& gl;
    const lamina::Device& device;
    const lamina::Environment& environment;
    const Settings& settings;

    [[nodiscard]] glm::uvec2 frame(double aspect) const {
        // Twice as many pixels as are shown.
        return {static_cast<std::uint32_t>(aspect * settings.size) * 2, settings.size * 2};
    }
    [[nodiscard]] lamina::Refraction refraction(RefractionModel model) const {
        lamina::RefractionDesc desc;
        desc.model = model;
        desc.voxels = settings.voxels;
        auto made = check(lamina::Refraction::create(device, desc));
        made.setEnvironment(environment);
        return made;
    }
};

lamina::RefractionReceiver receiverOf(const Stage& stage, std::uint32_t object) {
    lamina::RefractionReceiver receiver;
    receiver.view = stage.view;
    receiver.depthTexture = stage.depth;
    receiver.normalTexture = stage.normals;
    receiver.objectTexture = stage.objects;
    receiver.objectId = object;
    return receiver;
}

/// Bounds of a mesh after `model`.
lamina::Box3 boundsOf(const lamina::TriangleMesh& mesh, const glm::mat4& model) {
    lamina::Box3 bounds;
    for (const glm::vec3& position : mesh.positions)
        bounds.extend(glm::dvec3(model * glm::vec4(position, 1.0f)));
    return bounds;
}

/// A knotted tube, or the mesh of --mesh; centred, 2 units large.
lamina::TriangleMesh makeFigure(const Settings& settings) {
    lamina::TriangleMesh mesh;
    if (!settings.mesh.empty()) {
        mesh = check(lamina::readMesh(settings.mesh));
    } else {
        constexpr unsigned kSteps = 360;
        std::vector<glm::vec3> path;
        for (unsigned i = 0; i < kSteps; ++i) {
            const float t = glm::two_pi<float>() * static_cast<float>(i) / kSteps;
            const float ring = 1.0f + 0.42f * std::cos(3.0f * t);
            path.push_back(
                {ring * std::cos(2.0f * t), ring * std::sin(2.0f * t), 0.55f * std::sin(3.0f * t)});
        }
        example::addClosedTube(mesh, path, 0.3f, 48);
    }
    const lamina::Box3 bounds = mesh.bounds();
    const glm::dvec3 size = bounds.size();
    const auto scale = static_cast<float>(2.0 / std::max({size.x, size.y, size.z}));
    for (glm::vec3& position : mesh.positions)
        position = scale * (position - glm::vec3(bounds.center()));
    example::addNormals(mesh);
    return mesh;
}

/// [ED06] figure 11: one shape, many materials.
lamina::Image drawMaterials(const Studio& studio) {
    using lamina::AttenuationModel;
    std::vector<lamina::RefractionSettings> materials(5);
    materials[0].bendLength = 0.5f;                // Clear glass.
    materials[1].absorption = {2.6f, 0.9f, 0.25f}; // Sapphire.
    materials[1].refractiveIndex = 1.7f;
    materials[2].bodyBlur = 0.35f; // Frosted.
    materials[2].surfaceBlur = 0.06f;
    materials[2].absorption = {0.12f, 0.06f, 0.08f};
    materials[3].attenuation = AttenuationModel::Power; // Jade.
    materials[3].bodyColor = {0.10f, 0.33f, 0.17f};
    materials[3].opaqueLength = 0.9f;
    materials[3].exponent = 0.55f;
    materials[3].bodyBlur = 0.9f;
    materials[4].refractiveIndex = 1.05f; // A gas.
    materials[4].attenuation = AttenuationModel::Power;
    materials[4].bodyColor = {1.0f, 0.42f, 0.08f};
    materials[4].opaqueLength = 1.0f;
    materials[4].exponent = 1.4f;
    materials[4].reflection = 0.0f;

    const lamina::TriangleMesh mesh = makeFigure(studio.settings);
    const EngineMesh uploaded = example::upload(studio.gl, mesh);
    const auto count = static_cast<float>(materials.size());
    const Stage stage =
        example::makeStage(studio.gl, studio.frame(4.0), {0.0, 0.7, 9.6}, {0.0, -0.05, 0.0}, 16.5);
    example::beginStage(studio.gl, stage, studio.environment.texture());
    std::vector<glm::mat4> models;
    for (float i = 0.0f; i < count; ++i) {
        const glm::mat4 place =
            glm::translate(glm::mat4(1.0f), {2.05f * (i - 0.5f * (count - 1.0f)), 0.0f, 0.0f});
        models.push_back(glm::rotate(place, 0.35f - 0.15f * i, {0.2f, 1.0f, 0.0f}));
        example::drawObject(studio.gl, stage, uploaded, models.back(),
                            static_cast<std::uint32_t>(i) + 1);
    }
    // One Refraction serves all objects in turn.
    auto refraction = studio.refraction(RefractionModel::VolumeIntegral);
    for (std::size_t i = 0; i < materials.size(); ++i) {
        lamina::MeshView view = uploaded.view;
        view.model = models[i];
        const lamina::GeometrySource source = view;
        check(refraction.setSettings(materials[i]));
        lamina::RefractionObject object;
        object.sources = {&source, 1};
        object.bounds = boundsOf(mesh, models[i]);
        check(refraction.prepare(object, stage.view));
        check(refraction.apply(receiverOf(stage, static_cast<std::uint32_t>(i) + 1), stage.color));
    }
    return example::develop(studio.gl, stage, stage.color);
}

/// Coloured balls behind a clear and a frosted figure: what the engine has drawn is seen through.
lamina::Image drawFrosted(const Studio& studio) {
    const lamina::TriangleMesh mesh = makeFigure(studio.settings);
    const EngineMesh uploaded = example::upload(studio.gl, mesh);
    lamina::TriangleMesh ball;
    example::addRevolved(ball, example::ballProfile(0.32f, 40), 64,
                         [](const glm::vec3& p) { return p; });
    example::addNormals(ball);
    const EngineMesh balls = example::upload(studio.gl, ball);
    std::vector<lamina::Image> pictures;
    for (const float blur : {0.0f, 0.12f, 0.35f}) {
        const Stage stage = example::makeStage(studio.gl, studio.frame(1.1), {0.3, 0.9, 4.6},
                                               {0.0, 0.0, 0.0}, 32.0);
        example::beginStage(studio.gl, stage, studio.environment.texture());
        for (int i = 0; i < 15; ++i) {
            const glm::vec3 place(0.72f * static_cast<float>(i % 5 - 2),
                                  0.75f * static_cast<float>(i / 5 - 1), -1.6f);
            const glm::vec3 albedo =
                0.5f + 0.45f * glm::cos(glm::vec3(0.0f, 2.1f, 4.2f) + 1.3f * static_cast<float>(i));
            example::drawOpaque(studio.gl, stage, balls, glm::translate(glm::mat4(1.0f), place),
                                albedo);
        }
        example::drawObject(studio.gl, stage, uploaded, glm::mat4(1.0f), 1);
        auto refraction = studio.refraction(RefractionModel::VolumeIntegral);
        lamina::RefractionSettings material;
        material.bendLength = 1.0f;
        material.refractiveIndex = 1.3f;
        material.surfaceBlur = 0.2f * blur;
        material.bodyBlur = blur;
        material.behindDistance = 1.5f;
        material.absorption = {0.25f, 0.1f, 0.12f};
        check(refraction.setSettings(material));
        const lamina::GeometrySource source = uploaded.view;
        lamina::RefractionObject object;
        object.sources = {&source, 1};
        object.bounds = mesh.bounds();
        check(refraction.prepare(object, stage.view));
        lamina::RefractionReceiver receiver = receiverOf(stage, 1);
        receiver.colorTexture = stage.color;
        receiver.colorDepthTexture = stage.colorDepth;
        check(refraction.apply(receiver, stage.color));
        pictures.push_back(example::develop(studio.gl, stage, stage.color));
    }
    return example::sideBySide(pictures);
}

/// Share of light that a surface of glass reflects.
double fresnel(double cosine) {
    const double eta = 1.0 / kGlass;
    const double inner = std::sqrt(1.0 - eta * eta * (1.0 - cosine * cosine));
    const double s = (eta * cosine - inner) / (eta * cosine + inner);
    const double p = (cosine - eta * inner) / (cosine + eta * inner);
    return 0.5 * (s * s + p * p);
}

/// The vase ray-traced on the processor, pixel by pixel, over the picture. Like Lamina's models it
/// follows the refracted or totally reflected light alone; only the first surface also mirrors.
void traceVase(const Studio& studio, const Stage& stage, const glm::vec3& absorption) {
    std::vector<std::unique_ptr<example::GlassBody>> bodies;
    const auto profile = example::vaseProfile();
    bodies.push_back(example::makeRevolvedGlass(profile, kGlass));
    const glm::uvec2 size = stage.view.size;
    std::vector<glm::vec4> texels(std::size_t{size.x} * size.y);
    studio.gl.GetTextureImage(stage.color, 0, GL_RGBA, GL_FLOAT,
                              static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)),
                              texels.data());
    const glm::dmat4 clipToWorld = glm::inverse(stage.view.worldToClip);
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / glm::dvec2(size) * 2.0 - 1.0;
            const glm::dvec4 far = clipToWorld * glm::dvec4(at, 0.5, 1.0);
            const glm::dvec3 ray = glm::normalize(glm::dvec3(far) / far.w - stage.eye);
            const auto hit = example::hitGlass(bodies, stage.eye, ray);
            if (!hit || glm::dot(ray, hit->normal) >= 0.0)
                continue;
            const glm::dvec3 point = stage.eye + hit->distance * ray;
            const auto path = example::traceGlass(bodies, point, *hit, ray, 12);
            const glm::vec3 seen = example::sky(path.direction) *
                                   glm::exp(-absorption * static_cast<float>(path.inside));
            const auto share = static_cast<float>(fresnel(-glm::dot(ray, hit->normal)));
            const glm::vec3 mirrored = example::sky(glm::reflect(ray, hit->normal));
            texels[std::size_t{y} * size.x + x] = glm::vec4(glm::mix(seen, mirrored, share), 1.0f);
        }
    studio.gl.TextureSubImage2D(stage.color, 0, 0, 0, static_cast<GLsizei>(size.x),
                                static_cast<GLsizei>(size.y), GL_RGBA, GL_FLOAT, texels.data());
}

/// [CLN11] figure 4: a vase by two surfaces, by all surfaces, and ray-traced.
lamina::Image drawVase(const Studio& studio) {
    const glm::vec3 absorption(0.9f, 0.25f, 0.15f);
    const lamina::TriangleMesh mesh = example::makeRevolvedMesh(example::vaseProfile(), 192);
    const EngineMesh uploaded = example::upload(studio.gl, mesh);
    std::vector<lamina::Image> pictures;
    for (const int i : {0, 1, 2}) {
        const Stage stage = example::makeStage(studio.gl, studio.frame(0.8), {0.6, 0.9, 4.2},
                                               {0.0, 0.0, 0.0}, 32.0);
        example::beginStage(studio.gl, stage, studio.environment.texture());
        if (i == 2) {
            traceVase(studio, stage, absorption);
        } else {
            example::drawObject(studio.gl, stage, uploaded, glm::mat4(1.0f), 1);
            auto refraction = studio.refraction(i == 0 ? RefractionModel::TwoSurfaces
                                                       : RefractionModel::ManySurfaces);
            lamina::RefractionSettings settings;
            settings.absorption = absorption;
            check(refraction.setSettings(settings));
            lamina::Material glass;
            glass.refractiveIndex = static_cast<float>(kGlass);
            const lamina::GeometrySource source = uploaded.view;
            lamina::RefractionObject object;
            object.sources = {&source, 1};
            object.materials = {&glass, 1};
            object.bounds = mesh.bounds();
            check(refraction.prepare(object, stage.view));
            check(refraction.apply(receiverOf(stage, 1), stage.color));
        }
        pictures.push_back(example::develop(studio.gl, stage, stage.color));
    }
    return example::sideBySide(pictures);
}

/// [CLN11] figure 3: a figure of another material inside a ball of glass.
lamina::Image drawNested(const Studio& studio) {
    lamina::TriangleMesh ball;
    example::addRevolved(ball, example::ballProfile(1.0f, 96), 160,
                         [](const glm::vec3& p) { return p; });
    for (const glm::vec3& position : ball.positions)
        ball.normals.push_back(glm::normalize(position));
    lamina::TriangleMesh figure = makeFigure(studio.settings);
    for (glm::vec3& position : figure.positions)
        position *= 0.55f;
    const EngineMesh outer = example::upload(studio.gl, ball);
    const EngineMesh inner = example::upload(studio.gl, figure);
    lamina::Material materials[2];
    materials[0].refractiveIndex = 1.15f;
    materials[1].refractiveIndex = 1.6f;
    materials[1].color = {0.30f, 0.10f, 0.16f, 1.0f}; // Of light after one unit.
    std::vector<lamina::Image> pictures;
    for (const bool hasFigure : {false, true}) {
        const Stage stage = example::makeStage(studio.gl, studio.frame(1.0), {0.4, 0.8, 4.2},
                                               {0.0, 0.0, 0.0}, 32.0);
        example::beginStage(studio.gl, stage, studio.environment.texture());
        example::drawObject(studio.gl, stage, outer, glm::mat4(1.0f), 1);
        std::vector<lamina::GeometrySource> sources{outer.view};
        if (hasFigure) {
            lamina::MeshView view = inner.view;
            view.materialId = 1;
            sources.emplace_back(view);
        }
        auto refraction = studio.refraction(RefractionModel::ManySurfaces);
        lamina::RefractionObject object;
        object.sources = sources;
        object.materials = materials;
        object.bounds = ball.bounds();
        check(refraction.prepare(object, stage.view));
        check(refraction.apply(receiverOf(stage, 1), stage.color));
        pictures.push_back(example::develop(studio.gl, stage, stage.color));
    }
    return example::sideBySide(pictures);
}

/// A twist that the engine's vertex stage makes; normals follow by its derivative.
constexpr const char* kTwist = R"(
layout(location = 2) uniform float time;
void deform(inout vec3 position, inout vec3 normal) {
    float rate = 1.4 * sin(6.2831853 * time);
    float c = cos(rate * position.y);
    float s = sin(rate * position.y);
    vec3 n = vec3(c * normal.x - s * normal.z, normal.y, s * normal.x + c * normal.z);
    position = vec3(c * position.x - s * position.z, position.y, s * position.x + c * position.z);
    // The inverse transpose of the twist: y also turns x and z.
    n.y += rate * (position.z * n.x - position.x * n.z);
    normal = normalize(n);
}
)";

/// Geometry that exists only on the GPU, frame by frame.
lamina::Image drawAnimated(const Studio& studio) {
    const lamina::TriangleMesh mesh = makeFigure(studio.settings);
    const EngineMesh uploaded = example::upload(studio.gl, mesh);
    float time = 0.0f;
    lamina::DrawSource draws;
    draws.vertexShader = std::string(kTwist) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
LaminaVertex laminaVertex() {
    vec3 place = position;
    vec3 facing = normal;
    deform(place, facing);
    return LaminaVertex(place, facing, 0u);
}
)";
    draws.draw = [&](const lamina::DrawContext& context) {
        studio.gl.ProgramUniform1f(context.program, 2, time);
        example::draw(studio.gl, uploaded);
    };
    const lamina::GeometrySource source = draws;
    auto refraction = studio.refraction(RefractionModel::VolumeIntegral);
    lamina::RefractionSettings material;
    material.absorption = {0.2f, 0.7f, 1.8f};
    material.bodyBlur = 0.1f;
    check(refraction.setSettings(material));
    std::vector<lamina::Image> pictures;
    for (int i = 0; i < 4; ++i) {
        time = 0.25f * static_cast<float>(i) / 3.0f;
        const Stage stage = example::makeStage(studio.gl, studio.frame(0.9), {0.4, 0.8, 4.8},
                                               {0.0, 0.0, 0.0}, 32.0);
        example::beginStage(studio.gl, stage, studio.environment.texture());
        example::drawObject(studio.gl, stage, uploaded, glm::mat4(1.0f), 1, kTwist, time);
        lamina::RefractionObject object;
        object.sources = {&source, 1};
        object.bounds = {glm::dvec3(-1.5), glm::dvec3(1.5)};
        check(refraction.prepare(object, stage.view));
        check(refraction.apply(receiverOf(stage, 1), stage.color));
        pictures.push_back(example::develop(studio.gl, stage, stage.color));
    }
    return example::sideBySide(pictures);
}

lamina::Environment loadSky(const HostGl& gl, const lamina::Device& device) {
    constexpr std::uint32_t kRows = 1024;
    const std::vector<glm::vec3> texels = example::makeSkyTexels(kRows);
    GLuint texture = 0;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, GL_RGB32F, 2 * kRows, kRows);
    gl.TextureSubImage2D(texture, 0, 0, 0, 2 * kRows, kRows, GL_RGB, GL_FLOAT, texels.data());
    auto environment = check(lamina::Environment::create(device, {.size = 1024}));
    check(environment.loadEquirectangular(texture));
    return environment;
}

void run(const Settings& settings) {
    lamina::headless::Context context = check(lamina::headless::Context::create());
    const auto load = [&](const char* name) { return context.getProcAddress(name); };
    const HostGl gl(load);
    lamina::Device device = check(lamina::Device::fromCurrentContext(load));
    gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    const lamina::Environment environment = loadSky(gl, device);
    const Studio studio{gl, device, environment, settings};
    lamina::Image (*draw)(const Studio&) = settings.picture == "frosted"    ? drawFrosted
                                           : settings.picture == "vase"     ? drawVase
                                           : settings.picture == "nested"   ? drawNested
                                           : settings.picture == "animated" ? drawAnimated
                                                                            : drawMaterials;
    check(lamina::writePng(settings.file, draw(studio)));
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app("Refraction through glass, jade and frosted bodies.");
    app.add_option("file", settings.file, "The picture, a PNG")->required();
    app.add_option("--picture", settings.picture, "materials, frosted, vase, nested or animated")
        ->check(CLI::IsMember({"materials", "frosted", "vase", "nested", "animated"}));
    app.add_option("--mesh", settings.mesh, "A closed mesh instead of the knot");
    app.add_option("--size", settings.size, "Height of the picture, pixels")
        ->check(CLI::Range(16, 2048));
    app.add_option("--voxels", settings.voxels, "Voxels a side of volumes")
        ->check(CLI::Range(8, 1024));
    CLI11_PARSE(app, argc, argv);
    run(settings);
    return 0;
}
