// A lamp in fog, seen through a fence: one voxelized shadow volume ([WD13] 2.6) of 512 samples a
// side, whose beams a picture without it lacks. A point light, a spot light and the sun.
//
//   fog_point_light OUT.png [--width PIXELS] [--voxels N] [--light point|spot|sun|all]

#include "support/check.hpp"
#include "support/fog_stage.hpp"
#include "support/shapes.hpp"

#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace {

using lamina::TriangleMesh;

/// Bars in a ring, a ball in their middle.
TriangleMesh makeCage() {
    TriangleMesh mesh;
    constexpr int kBars = 14;
    for (int bar = 0; bar < kBars; ++bar) {
        const float angle = 6.2831853f * static_cast<float>(bar) / kBars;
        const glm::vec3 foot(1.1f * std::cos(angle), 0.0f, 1.1f * std::sin(angle));
        const glm::vec3 path[] = {foot, foot + glm::vec3(0.0f, 1.7f, 0.0f)};
        const float radii[] = {0.05f, 0.05f};
        example::addTube(mesh, path, radii, 12);
    }
    return mesh;
}

TriangleMesh makeBall() {
    TriangleMesh mesh;
    example::addRevolved(mesh, example::ballProfile(0.42f, 48), 64,
                         [](const glm::vec3& p) { return p + glm::vec3(2.2f, 0.42f, 0.6f); });
    return mesh;
}

TriangleMesh makeGround() {
    TriangleMesh mesh;
    constexpr float kSide = 14.0f;
    mesh.positions = {
        {-kSide, 0, -kSide}, {kSide, 0, -kSide}, {kSide, 0, kSide}, {-kSide, 0, kSide}};
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    return mesh;
}

} // namespace

int main(int argc, char** argv) {
    std::string file;
    std::uint32_t width = 480;
    std::uint32_t voxels = 512;
    std::string wanted = "all";
    CLI::App app("Hard shadows of one light in fog.");
    app.add_option("file", file, "The picture, a PNG")->required();
    app.add_option("--width", width, "Pixels of each of its parts")->check(CLI::Range(16, 4096));
    app.add_option("--voxels", voxels, "Of the shadow volume, along alpha, theta and phi")
        ->check(CLI::Range(1, 2048));
    app.add_option("--light", wanted, "point, spot, sun: without and with shadows; or all")
        ->check(CLI::IsMember({"point", "spot", "sun", "all"}));
    CLI11_PARSE(app, argc, argv);

    example::FogStage stage;
    stage.add(makeGround(), glm::vec3(0.32f, 0.31f, 0.3f));
    stage.add(makeCage(), glm::vec3(0.5f, 0.4f, 0.25f));
    stage.add(makeBall(), glm::vec3(0.6f, 0.2f, 0.15f));
    const glm::uvec2 size(width, width * 5 / 8);
    stage.draw(
        glm::perspective(glm::radians(42.0), static_cast<double>(size.x) / size.y, 0.2, 40.0) *
            glm::lookAt(glm::dvec3(0.6, 2.3, 7.0), glm::dvec3(0.3, 0.7, 0.0), glm::dvec3(0, 1, 0)),
        size);

    lamina::AreaLightDesc desc;
    desc.voxels = glm::uvec3(voxels);
    desc.mapTexels = 2 * voxels;
    desc.farDistance = 16.0; // The fog hides what lies beyond.
    const lamina::Medium fog{0.11f, glm::vec3(0.95f), 0.1f};
    const lamina::PointLight lamp{{0.0, 0.85, 0.0}, glm::vec3(9.0f, 7.5f, 5.0f)};
    const lamina::SpotLight spot{
        {-3.0, 3.4, -1.5}, {3.4, -3.0, 1.6}, 0.42, glm::vec3(70.0f, 80.0f, 95.0f)};
    const lamina::DirectionalLight sun{{0.5, -0.8, 0.75}, glm::vec3(3.2f, 2.9f, 2.4f)};
    const std::pair<const char*, lamina::LightSource> lights[] = {
        {"point", lamp}, {"spot", spot}, {"sun", sun}};
    std::vector<lamina::Image> images;
    for (const auto& [name, light] : lights) {
        if (wanted == name || (wanted == "all" && images.empty()))
            images.push_back(stage.light(desc, light, fog, false));
        if (wanted == name || wanted == "all")
            images.push_back(stage.light(desc, light, fog));
    }
    example::check(lamina::writePng(file, example::montage(images, 2)));
    std::printf("%s: %s\n", file.c_str(),
                wanted == "all" ? "a lamp without and with shadows, a spot light, the sun"
                                : "without and with shadows");
    return 0;
}
