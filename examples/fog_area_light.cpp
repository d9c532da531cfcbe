// A large television in fog, behind a fence, columns and a tree: imperfect voxelized shadow volumes
// of [WD13], and the pictures that its figures show.
//
//   fog_area_light FOLDER [--figure FIGURE ...] [--width PIXELS] [--lights N] [--voxels A T P]
//                  [--map-texels N] [--maps KIND] [--gather WAY] [--airlight FORM]
//
// Figures: shadows (without and with, Fig. 1), hard (a point and the area, Fig. 2), resolution (of
// maps and volumes at once, Fig. 6), alpha (detached shadows, Fig. 7), samples (of one volume, Fig.
// 8), sizes (Fig. 11), interpolation (8 lights without and with, Fig. 13), gather (full,
// interleaved, quarter and their differences), or all.

#include "support/check.hpp"
#include "support/fog_stage.hpp"
#include "support/shapes.hpp"
#include "support/tree.hpp"

#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <vector>

namespace {

using example::check;
using lamina::Image;
using lamina::TriangleMesh;

const glm::dvec3 kEye(0.4, 1.5, 6.2);

void addBox(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high) {
    constexpr int kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const auto corner = [&](int i) {
        return glm::vec3((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                         (i & 4) != 0 ? high.z : low.z);
    };
    for (const auto& side : kSides) {
        example::addTriangle(mesh, corner(side[0]), corner(side[1]), corner(side[2]));
        example::addTriangle(mesh, corner(side[0]), corner(side[2]), corner(side[3]));
    }
}

TriangleMesh makeFence() {
    TriangleMesh mesh;
    for (int bar = 0; bar < 11; ++bar) {
        const float x = -0.9f + 0.18f * static_cast<float>(bar);
        addBox(mesh, {x, 0.0f, -0.72f}, {x + 0.05f, 1.15f, -0.68f});
    }
    for (const float y : {0.25f, 0.9f})
        addBox(mesh, {-1.0f, y, -0.71f}, {1.0f, y + 0.05f, -0.69f});
    return mesh;
}

TriangleMesh makeColumns() {
    TriangleMesh mesh;
    const std::vector<glm::vec2> profile{{0.0f, 0.0f},   {0.34f, 0.01f}, {0.34f, 0.12f},
                                         {0.22f, 0.2f},  {0.18f, 2.3f},  {0.3f, 2.4f},
                                         {0.32f, 2.55f}, {0.0f, 2.56f}};
    for (const float x : {-2.3f, 1.7f})
        example::addRevolved(mesh, profile, 40,
                             [x](const glm::vec3& p) { return p + glm::vec3(x, 0.0f, -0.3f); });
    return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, float scale, const glm::vec3& place) {
    for (glm::vec3& position : mesh.positions)
        position = scale * position + place;
    return mesh;
}

/// A frame of a film: a sunset over a sea.
std::vector<glm::vec3> makeFilm(const glm::uvec2& size) {
    std::vector<glm::vec3> texels;
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size.x);
            const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size.y);
            const float sun =
                std::exp(-60.0f * ((u - 0.7f) * (u - 0.7f) + (v - 0.45f) * (v - 0.45f)));
            const glm::vec3 sky =
                glm::mix(glm::vec3(1.0f, 0.35f, 0.08f), glm::vec3(0.12f, 0.25f, 0.75f),
                         std::min(1.0f, v * 1.2f));
            const glm::vec3 sea(0.02f, 0.18f + 0.1f * std::sin(40.0f * v), 0.3f);
            texels.push_back((v < 0.35f ? sea : sky) + sun * glm::vec3(5.0f, 3.0f, 1.2f));
        }
    return texels;
}

class Figures {
public:
    Figures(std::filesystem::path folder, std::uint32_t width, const lamina::AreaLightDesc& desc)
        : mFolder(std::move(folder))
        , mWidth(width)
        , mDesc(desc) {
        TriangleMesh ground;
        addBox(ground, {-12.0f, -0.1f, -12.0f}, {12.0f, 0.0f, 12.0f});
        const example::Tree tree = example::makeTree(5);
        const glm::vec3 place(-0.9f, 0.0f, 0.7f);
        mStage.add(ground, glm::vec3(0.35f, 0.33f, 0.3f));
        mStage.add(makeFence(), glm::vec3(0.5f, 0.42f, 0.3f));
        mStage.add(makeColumns(), glm::vec3(0.6f));
        mStage.add(scaled(tree.wood, 0.28f, place), glm::vec3(0.3f, 0.2f, 0.12f));
        mStage.add(scaled(tree.leaves, 0.28f, place), glm::vec3(0.2f, 0.4f, 0.08f));
        const glm::uvec2 filmSize(256, 128);
        mFilm = mStage.makeTexture(makeFilm(filmSize), filmSize);
    }

    void shadows() {
        draw(mWidth, 1.0);
        write("area_light", mStage.light(mDesc, light(1.0), kFog));
        draw(mWidth / 2, 1.0);
        write("without_and_with", example::montage({mStage.light(mDesc, light(1.0), kFog, false),
                                                    mStage.light(mDesc, light(1.0), kFog)},
                                                   2));
    }
    void hard() {
        draw(mWidth / 2, 1.0);
        write("hard_and_soft", example::montage({mStage.light(fine(512), middle(), kFog),
                                                 mStage.light(mDesc, light(1.0), kFog)},
                                                2));
    }
    void sizes() {
        std::vector<Image> images;
        for (const double size : {0.1, 0.4, 0.8, 1.2}) {
            draw(mWidth / 2, size);
            images.push_back(mStage.light(mDesc, light(size), kFog));
        }
        write("sizes", example::montage(images, 2));
    }
    void interpolation() {
        draw(mWidth / 2, 1.0);
        lamina::AreaLightDesc few = mDesc;
        few.virtualLights = 8;
        few.voxels = glm::uvec3(64);
        few.maps = lamina::ShadowMaps::Rendered;
        lamina::AreaLightDesc plain = few;
        plain.interpolate = false;
        write("interpolation",
              example::montage(
                  {mStage.light(plain, light(1.0), kFog), mStage.light(few, light(1.0), kFog)}, 2));
    }
    void resolution() {
        draw(mWidth / 2, 1.0);
        std::vector<Image> images;
        for (const std::uint32_t voxels : {16u, 32u, 64u, 128u}) {
            lamina::AreaLightDesc other = mDesc;
            other.voxels = glm::uvec3(voxels);
            other.mapTexels = voxels;
            images.push_back(mStage.light(other, light(1.0), kFog));
        }
        write("resolution", example::montage(images, 2));
    }
    void alpha() {
        draw(mWidth / 2, 1.0);
        std::vector<Image> images;
        for (const std::uint32_t voxels : {16u, 64u, 128u, 512u}) {
            lamina::AreaLightDesc other = fine(512);
            other.voxels.x = voxels;
            images.push_back(mStage.light(other, middle(), kFog));
        }
        write("alpha", example::montage(images, 2));
    }
    void samples() {
        draw(mWidth / 4, 1.0);
        std::vector<Image> images;
        for (const std::uint32_t voxels : {32u, 128u, 512u})
            for (int column = 0; column < 4; ++column) {
                lamina::AreaLightDesc other = fine(512);
                if (column == 0 || column == 3)
                    other.mapTexels = 2 * voxels;
                if (column == 1 || column == 3)
                    other.voxels.z = voxels;
                if (column == 2 || column == 3)
                    other.voxels.y = voxels;
                if (column == 3)
                    other.voxels.x = voxels;
                images.push_back(mStage.light(other, middle(), kFog));
            }
        write("samples", example::montage(images, 4));
    }
    void gather() {
        draw(mWidth / 2, 1.0);
        std::vector<Image> images;
        for (const lamina::GatherMode mode :
             {lamina::GatherMode::Full, lamina::GatherMode::Interleaved,
              lamina::GatherMode::Quarter}) {
            lamina::AreaLightDesc other = mDesc;
            other.gather = mode;
            images.push_back(mStage.light(other, light(1.0), kFog));
        }
        for (std::size_t i = 0; i < 3; ++i)
            images.push_back(example::difference(images[0], images[i], 4));
        write("gather", example::montage(images, 3));
    }

private:
    static constexpr lamina::Medium kFog{0.13f, glm::vec3(0.95f), 0.25f};

    /// One volume of this many samples along each axis.
    [[nodiscard]] lamina::AreaLightDesc fine(std::uint32_t voxels) const {
        lamina::AreaLightDesc made = mDesc;
        made.voxels = glm::uvec3(voxels);
        made.mapTexels = 2 * voxels;
        return made;
    }
    /// A lamp in the middle of the television, as strong as all of it seen from the front.
    [[nodiscard]] lamina::PointLight middle() const {
        const lamina::RectangleLight whole = light(1.0);
        return {whole.corner + 0.5 * (whole.edgeU + whole.edgeV), glm::vec3(40.0f, 34.0f, 36.0f)};
    }
    /// The television, of a share of its full size.
    [[nodiscard]] lamina::RectangleLight light(double size) const {
        lamina::RectangleLight made;
        const glm::dvec3 middle(0.0, 1.55, -3.4);
        made.edgeU = {3.6 * size, 0.0, 0.0};
        made.edgeV = {0.0, 1.9 * size, 0.0};
        made.corner = middle - 0.5 * (made.edgeU + made.edgeV);
        // As much light from any size.
        made.emission.radiance = glm::vec3(static_cast<float>(16.0 / (size * size)));
        made.emission.texture = mFilm;
        return made;
    }
    void draw(std::uint32_t width, double size) {
        const lamina::RectangleLight rectangle = light(size);
        const glm::dvec3 corners[4] = {rectangle.corner, rectangle.corner + rectangle.edgeU,
                                       rectangle.corner + rectangle.edgeU + rectangle.edgeV,
                                       rectangle.corner + rectangle.edgeV};
        const glm::vec3 rounded[4] = {corners[0], corners[1], corners[2], corners[3]};
        mStage.removeGlows();
        mStage.addGlow(rounded, glm::vec3(2.5f), mFilm);
        const glm::uvec2 pixels(width, width * 5 / 8);
        const glm::dmat4 projection = glm::perspective(
            glm::radians(42.0), static_cast<double>(pixels.x) / pixels.y, 0.2, 30.0);
        mStage.draw(projection *
                        glm::lookAt(kEye, glm::dvec3(0.0, 1.15, -1.0), glm::dvec3(0, 1, 0)),
                    pixels);
    }
    void write(const std::string& name, const Image& image) const {
        const std::filesystem::path file = mFolder / (name + ".png");
        check(lamina::writePng(file, image));
        std::printf("%s\n", file.string().c_str());
    }

    std::filesystem::path mFolder;
    std::uint32_t mWidth;
    lamina::AreaLightDesc mDesc;
    example::FogStage mStage;
    std::uint32_t mFilm = 0;
};

/// An option whose values are the names of enumerators.
template<class Choice>
void addChoice(CLI::App& app, const std::string& option, const std::string& what,
               const std::map<std::string, Choice>& choices, Choice& chosen) {
    std::vector<std::string> names;
    for (const auto& [name, value] : choices)
        names.push_back(name);
    app.add_option_function<std::string>(
           option, [&choices, &chosen](const std::string& name) { chosen = choices.at(name); },
           what)
        ->check(CLI::IsMember(names));
}

} // namespace

int main(int argc, char** argv) {
    const std::map<std::string, void (Figures::*)()> all = {
        {"shadows", &Figures::shadows},
        {"hard", &Figures::hard},
        {"resolution", &Figures::resolution},
        {"alpha", &Figures::alpha},
        {"samples", &Figures::samples},
        {"sizes", &Figures::sizes},
        {"interpolation", &Figures::interpolation},
        {"gather", &Figures::gather}};
    std::string folder;
    std::vector<std::string> figures{"shadows"};
    std::uint32_t width = 640;
    std::vector<std::uint32_t> voxels{128, 128, 128};
    lamina::AreaLightDesc desc;
    desc.virtualLights = 128;

    CLI::App app("A large television in fog.");
    app.add_option("folder", folder, "Where the pictures go, PNGs")->required();
    std::vector<std::string> names{"all"};
    for (const auto& [name, run] : all)
        names.push_back(name);
    app.add_option("--figure", figures, "One or more of the pictures, or all")
        ->check(CLI::IsMember(names));
    app.add_option("--width", width, "Pixels of the largest picture")->check(CLI::Range(64, 4096));
    app.add_option("--lights", desc.virtualLights, "Virtual lights of the television")
        ->check(CLI::Range(1, 1024));
    app.add_option("--voxels", voxels, "Of each shadow volume, along alpha, theta and phi")
        ->expected(3)
        ->check(CLI::Range(1, 2048));
    app.add_option("--map-texels", desc.mapTexels, "A side of each shadow map")
        ->check(CLI::Range(4, 8192));
    // Choices by name; CLI's own transformers print enumerators as numbers.
    const std::map<std::string, lamina::ShadowMaps> maps{
        {"automatic", lamina::ShadowMaps::Automatic},
        {"imperfect", lamina::ShadowMaps::Imperfect},
        {"rendered", lamina::ShadowMaps::Rendered}};
    const std::map<std::string, lamina::GatherMode> gathers{
        {"full", lamina::GatherMode::Full},
        {"interleaved", lamina::GatherMode::Interleaved},
        {"quarter", lamina::GatherMode::Quarter}};
    const std::map<std::string, lamina::AirlightForm> forms{
        {"factored", lamina::AirlightForm::Factored}, {"weighted", lamina::AirlightForm::Weighted}};
    addChoice(app, "--maps", "Shadow maps", maps, desc.maps);
    addChoice(app, "--gather", "Of lights", gathers, desc.gather);
    addChoice(app, "--airlight", "Visibility in it", forms, desc.airlight);
    CLI11_PARSE(app, argc, argv);
    desc.voxels = {voxels[0], voxels[1], voxels[2]};

    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (!std::filesystem::is_directory(folder, failed)) {
        std::fprintf(stderr, "fog_area_light: expected a folder to write to, found '%s'%s%s\n",
                     folder.c_str(), failed ? ": " : "", failed ? failed.message().c_str() : "");
        return 1;
    }
    Figures drawn(folder, width, desc);
    for (const auto& [name, run] : all)
        for (const std::string& figure : figures)
            if (figure == name || figure == "all")
                (drawn.*run)();
    return 0;
}
