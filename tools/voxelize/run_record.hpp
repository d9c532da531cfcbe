#pragma once

#include "grid_plan.hpp"
#include "stage_clock.hpp"

#include <lamina/grid/bit_grid.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/mesh_io/mesh_report.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lamina::tool {

struct MeshFacts {
    std::filesystem::path file;
    std::uint64_t fileBytes = 0;
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;
    Box3 bounds;
    bool hasColors = false;
    bool hasNormals = false;
    std::optional<MeshReport> report; ///< Where it was asked for: it takes time.
};

struct RendererFacts {
    headless::ContextInfo context;
    std::vector<std::string> attempts; ///< Contexts that failed before.
    bool isSoftware = false;
};

struct SolidFacts {
    SolidRule rule = SolidRule::Parity;
    bool isRuleChosen = false; ///< Not from the command line.
    SolidReport report;
};

struct VoxelFacts {
    std::string backend;
    std::string reason; ///< Why this backend.
    std::string coverage;
    std::uint32_t passes = 0;
    std::uint64_t deviceBytes = 0;
    std::uint64_t set = 0;
    bool hasColors = false;
    bool hasNormals = false;
    std::optional<SolidFacts> solid; ///< Of solid coverage.
};

/// A row of --compare.
struct ComparedMethod {
    std::string coverage;
    std::string solidRule; ///< Empty for other coverages.
    std::string exact;     ///< What it is measured against: a coverage, and a rule.
    std::string backend;
    double milliseconds = 0.0; ///< Median, until the GPU is done.
    std::uint32_t passes = 0;
    std::uint64_t deviceBytes = 0;
    std::uint64_t set = 0;
    BitGridComparison againstExact; ///< First: the exact set; second: this method's.
};

struct FileFacts {
    std::filesystem::path file;
    std::string format;
    std::uint64_t bytes = 0;
    double milliseconds = 0.0;
};

/// What a run did: filled step by step, then told as JSON and as text.
struct RunRecord {
    MeshFacts mesh;
    std::optional<GridPlan> grid;
    std::optional<RendererFacts> renderer;
    std::optional<VoxelFacts> voxels;
    std::vector<ComparedMethod> comparison;
    std::vector<FileFacts> files;
    std::vector<StageTime> stages;
    double totalMilliseconds = 0.0;
};

} // namespace lamina::tool
