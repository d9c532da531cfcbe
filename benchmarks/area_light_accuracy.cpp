// Errors of light in fog against ray casting (Embree): by their causes, and over virtual lights and
// resolutions. Prints Markdown.
//
//   lamina_area_light_accuracy [--quick] [--context=auto|egl|osmesa] [--pixels=N] [--scene=NAME]
//                              [--part=causes|times|sizes|picture]
//
// N pixels a side are compared; a picture of 256 x 256 pixels, thinned out. "picture" writes
// fog_NAME.pgm to the working directory.

#include "gl/device_state.hpp"
#include "gl/support/fog_trial.hpp"

#include <lamina/headless/context.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace lamina;
using reference::FogErrors;
using test::FogTrial;

template<class T>
T need(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "lamina_area_light_accuracy: %s\n", result.error().text.c_str());
        std::exit(1);
    }
    return std::move(*result);
}

struct Options {
    bool isQuick = false;
    headless::ContextDesc context;
    std::uint32_t pixels = 32;
    std::string scene;
    std::string part;
};

void printRow(const char* what, const FogErrors& errors) {
    std::printf("| %s | %.2f %% | %.1f %% (%+.1f %%) | |\n", what, 100.0 * errors.airlight,
                100.0 * errors.strength, 100.0 * errors.bias);
    std::fflush(stdout);
}

void printRow(const char* what, const FogTrial::Errors& errors) {
    std::printf("| %s | %.2f %% | %.1f %% (%+.1f %%) | %.2f %% |\n", what,
                100.0 * errors.truth.airlight, 100.0 * errors.truth.strength,
                100.0 * errors.truth.bias, 100.0 * errors.factored);
    std::fflush(stdout);
}

void printCauses(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
                 const Options& options) {
    const std::uint32_t lights = options.isQuick ? 16 : 256;
    FogTrial trial(device, gl, study, glm::uvec2(options.pixels), lights, 64);
    AreaLightDesc desc;
    desc.virtualLights = lights;
    std::printf("\n%s: %u virtual lights, 128-cubed volumes, %zu of %u x %u pixels\n\n"
                "| | airlight, RMSE | strength of the shadow (with its sign) | airlight against "
                "factored rays |\n"
                "|---|---|---|---|\n",
                study.name, lights, trial.pixels().size(), options.pixels, options.pixels);
    desc.maps = ShadowMaps::Imperfect;
    printRow("imperfect maps", trial.gather(desc));
    desc.airlight = AirlightForm::Factored;
    printRow("imperfect maps, factored", trial.gather(desc));
    desc.maps = ShadowMaps::Rendered;
    printRow("drawn maps, factored", trial.gather(desc));
    desc.airlight = AirlightForm::Weighted;
    printRow("drawn maps", trial.gather(desc));
    desc.interpolate = false;
    printRow("drawn maps, not interpolated", trial.gather(desc));
    desc.interpolate = true;
    desc.mapTexels = options.isQuick ? 256 : 1024;
    printRow("drawn maps, 8 times the texels a side", trial.gather(desc));
    printRow("perfect volumes", trial.perfect({true, true, true, true}));
    printRow("perfect volumes, not interpolated", trial.perfect({true, true, true, false}));
    printRow("steps in alpha alone", trial.perfect({true, false, false, true}));
    printRow("steps in theta alone", trial.perfect({false, true, false, true}));
    printRow("steps in phi alone", trial.perfect({false, false, true, true}));
    printRow("steps of the ray casting alone", trial.perfect({false, false, false, true}));
    printRow("factoring alone", trial.factoring());
}

double gatherTime(const FogTrial::Errors& errors) {
    return errors.times[static_cast<std::size_t>(AreaLightStage::Gather)];
}

void printSizes(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
                const Options& options) {
    const std::uint32_t most = options.isQuick ? 64 : 1024;
    FogTrial trial(device, gl, study, glm::uvec2(options.pixels), options.isQuick ? 256 : 4096, 16);
    std::printf("\n%s: airlight, RMSE (strength of the shadow) against the area light, drawn maps "
                "with a texel a voxel\n\n| virtual lights | 64-cubed | 128-cubed | 256-cubed |\n"
                "|---|---|---|---|\n",
                study.name);
    for (std::uint32_t lights = 16; lights <= most; lights *= 4) {
        std::printf("| %u |", lights);
        for (const std::uint32_t voxels : {64u, 128u, 256u}) {
            if (options.isQuick && voxels > 128)
                continue;
            AreaLightDesc desc;
            desc.virtualLights = lights;
            desc.maps = ShadowMaps::Rendered;
            desc.voxels = glm::uvec3(voxels);
            desc.mapTexels = voxels;
            const FogTrial::Errors errors = trial.gather(desc);
            std::printf(" %.2f %% (%.1f %%) |", 100.0 * errors.truth.airlight,
                        100.0 * errors.truth.strength);
            std::fflush(stdout);
        }
        std::printf("\n");
    }
}

void printTimes(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
                const Options& options) {
    const std::uint32_t lights = options.isQuick ? 16 : 256;
    FogTrial trial(device, gl, study, glm::uvec2(2 * options.pixels), lights, 1);
    AreaLightDesc desc;
    desc.virtualLights = lights;
    desc.measure = true;
    const double weighted = gatherTime(trial.gather(desc));
    desc.airlight = AirlightForm::Factored;
    const double factored = gatherTime(trial.gather(desc));
    std::printf("\n%s: gather weighted %.1f ms, factored %.1f ms: %.2f times\n", study.name,
                weighted, factored, weighted / factored);
    std::fflush(stdout);
}

/// PGM: ours, ray casting, and four times their difference around gray ([WD13] figure 12).
void writePicture(const Device& device, const GladGLContext& gl, const reference::FogStudy& study,
                  const Options& options) {
    FogTrial trial(device, gl, study, glm::uvec2(options.pixels), options.isQuick ? 16 : 256, 24);
    AreaLightDesc desc;
    desc.virtualLights = options.isQuick ? 16 : 256;
    desc.maps = ShadowMaps::Rendered;
    (void)trial.gather(desc);
    double white = 0.0;
    for (const double value : trial.truth())
        white = std::max(white, value);
    const std::size_t side = options.pixels;
    std::vector<unsigned char> texels(3 * side * side, 0);
    const auto gray = [&](double value) {
        return static_cast<unsigned char>(255.0 * std::clamp(value / white, 0.0, 1.0));
    };
    for (std::size_t i = 0; i < trial.pixels().size(); ++i) {
        const std::size_t pixel = trial.pixels()[i];
        const std::size_t row = (side - 1 - pixel / side) * 3 * side + pixel % side;
        const double found = trial.found()[i];
        const double truth = trial.truth()[i];
        texels[row] = gray(found);
        texels[row + side] = gray(truth);
        texels[row + 2 * side] = gray(0.5 * white + 4.0 * (found - truth));
    }
    const std::string path = std::string("fog_") + study.name + ".pgm";
    std::ofstream out(path, std::ios::binary);
    out << "P5 " << 3 * side << " " << side << " 255\n";
    out.write(reinterpret_cast<const char*>(texels.data()),
              static_cast<std::streamsize>(texels.size()));
    std::printf("\n%s: %s\n", study.name, path.c_str());
}

bool parse(int argc, char** argv, Options& options) {
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const auto value = [&](const char* name) {
            const std::string prefix = std::string("--") + name + "=";
            return argument.rfind(prefix, 0) == 0 ? argument.substr(prefix.size()) : std::string();
        };
        if (argument == "--quick") {
            options.isQuick = true;
            options.pixels = 8;
        } else if (argument == "--context=egl")
            options.context.api = headless::ContextApi::Egl;
        else if (argument == "--context=osmesa")
            options.context.api = headless::ContextApi::OsMesa;
        else if (!value("pixels").empty())
            options.pixels = static_cast<std::uint32_t>(std::atoi(value("pixels").c_str()));
        else if (!value("scene").empty())
            options.scene = value("scene");
        else if (!value("part").empty())
            options.part = value("part");
        else if (argument != "--context=auto")
            return false;
    }
    return options.pixels > 0;
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    if (!parse(argc, argv, options)) {
        std::fprintf(stderr, "usage: lamina_area_light_accuracy [--quick] "
                             "[--context=auto|egl|osmesa] [--pixels=N] [--scene=NAME] "
                             "[--part=causes|times|sizes|picture]\n");
        return 2;
    }
    headless::Context context = need(headless::Context::create(options.context));
    const Device device = need(
        Device::fromCurrentContext([&](const char* name) { return context.getProcAddress(name); }));
    const GladGLContext& gl = device.state()->gl;
    std::printf("%s\n", device.info().renderer.c_str());
    const auto isWanted = [&](const char* part) {
        return options.part.empty() || options.part == part;
    };
    for (const reference::FogStudy& study : reference::makeFogStudies()) {
        if (!options.scene.empty() && options.scene != study.name)
            continue;
        if (isWanted("causes"))
            printCauses(device, gl, study, options);
        if (isWanted("times"))
            printTimes(device, gl, study, options);
        if (isWanted("sizes"))
            printSizes(device, gl, study, options);
        if (options.part == "picture")
            writePicture(device, gl, study, options);
    }
    return 0;
}
