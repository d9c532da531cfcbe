#pragma once

#include "grid_plan.hpp"

#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace lamina::tool {

struct PreviewRequest {
    std::filesystem::path file;
    glm::dvec3 view{0.62, 0.42, 0.86}; ///< From the mesh towards the viewer, not zero.
    glm::uvec2 size{1024, 1024};       ///< Pixels.
};

/// Which attributes of voxels to make.
struct AttributeRequest {
    /// Colours, if the mesh has any and a file holds them without another file beside it.
    bool isAutomatic = true;
    bool color = false;
    bool normal = false;
};

struct StatsRequest {
    std::filesystem::path file; ///< "-": standard output.
    [[nodiscard]] bool toStandardOutput() const { return file == "-"; }
};

/// Everything the command line says.
struct Request {
    std::filesystem::path mesh;
    GridRequest grid;
    Coverage coverage = Coverage::Conservative;
    std::optional<SolidRule> solidRule; ///< Nothing: by what the mesh is like.
    Backend backend = Backend::Automatic;
    AttributeRequest attributes;
    headless::ContextApi context = headless::ContextApi::Automatic;
    Axis up = Axis::Y;
    double memoryLimitBytes = 0.0;
    std::vector<std::filesystem::path> outputs;
    std::optional<PreviewRequest> preview;
    std::optional<StatsRequest> stats;
    bool infoOnly = false;                    ///< Describe mesh and grid, voxelize nothing.
    bool compare = false;                     ///< Measure all methods, write no voxels.
    std::optional<Coverage> comparedCoverage; ///< Only this one's methods.
    bool listContexts = false;                ///< Nothing else.
    bool quiet = false;
    bool verbose = false;
};

} // namespace lamina::tool
