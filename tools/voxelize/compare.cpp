#include "compare.hpp"

#include "choices.hpp"
#include "device_work.hpp"
#include "failure.hpp"
#include "open_device.hpp"

#include <lamina/grid/voxel_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace lamina::tool {
namespace {

/// A method is timed this often, fewer times if that would take longer than the budget.
constexpr std::size_t kMostRuns = 7;
constexpr double kBudgetMilliseconds = 2000.0;

/// The coverage whose exact set a coverage is measured against.
Coverage exactCoverage(Coverage coverage) {
    return coverage == Coverage::Solid ? Coverage::Solid : Coverage::Conservative;
}

class Comparison {
public:
    /// exactRule: of the exact solid.
    Comparison(const OpenDevice& open, const MeshBuffers& buffers, const GridTransform& transform,
               SolidRule exactRule)
        : mOpen(open)
        , mSources{buffers.view()}
        , mTransform(transform)
        , mExactRule(exactRule) {}

    /// A row of the table; nothing if the backend does not serve the coverage here.
    /// rule: of Coverage::Solid.
    [[nodiscard]] std::optional<ComparedMethod> measure(Backend backend, Coverage coverage,
                                                        SolidRule rule) {
        auto created = Voxelizer::create(
            mOpen.device, {.backend = backend, .coverage = coverage, .solidRule = rule});
        if (!created && created.error().code == ErrorCode::Unsupported)
            return std::nullopt;
        const auto voxelizer = require(std::move(created));
        VoxelGrid grid = require(VoxelGrid::create(mOpen.device));
        const auto run = [&] {
            const Stopwatch watch;
            mStats = require(voxelizer->voxelize(mSources, mTransform, grid));
            mOpen.wait();
            return watch.milliseconds();
        };
        run(); // compiles for this size
        const Stopwatch total;
        std::vector<double> times;
        do
            times.push_back(run());
        while (times.size() < kMostRuns && total.milliseconds() < kBudgetMilliseconds);
        std::ranges::nth_element(times,
                                 times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));

        const BitGrid bits = downloadUniform(grid);
        const bool isSolid = coverage == Coverage::Solid;
        return ComparedMethod{std::string(name(coverage)),
                              isSolid ? std::string(wordOf(kSolidRules, rule)) : std::string(),
                              isSolid ? "solid " + std::string(wordOf(kSolidRules, mExactRule))
                                      : std::string(name(Coverage::Conservative)),
                              std::string(name(backend)),
                              times[times.size() / 2],
                              mStats.passes,
                              mStats.gridBytes,
                              bits.count(),
                              require(compare(exact(exactCoverage(coverage)), bits))};
    }

private:
    /// The exact set: triangle/voxel overlap, or crossings, decided by the overlap backend. Rays
    /// vote where no parity is exact, which is as near as can be had then.
    const BitGrid& exact(Coverage coverage) {
        auto found = mExact.find(coverage);
        if (found == mExact.end()) {
            VoxelGrid grid = require(VoxelGrid::create(mOpen.device));
            const auto voxelizer = require(Voxelizer::create(
                mOpen.device,
                {.backend = Backend::Overlap, .coverage = coverage, .solidRule = mExactRule}));
            (void)require(voxelizer->voxelize(mSources, mTransform, grid));
            found = mExact.emplace(coverage, require(grid.download())).first;
        }
        return found->second;
    }

    const OpenDevice& mOpen;
    std::array<GeometrySource, 1> mSources;
    GridTransform mTransform;
    SolidRule mExactRule;
    VoxelizeStats mStats;
    std::map<Coverage, BitGrid> mExact;
};

} // namespace

void compareOnDevice(const Request& request, const TriangleMesh& mesh, StageClock& clock,
                     RunRecord& record) {
    const GridPlan& plan = *record.grid;
    const GridTransform transform =
        require(GridTransform::box(plan.bounds, plan.counts, plan.axis));
    const OpenDevice open = openDevice(request, clock, record);
    const MeshBuffers buffers = clock.run("upload", "uploading the mesh", [&] {
        return require(MeshBuffers::upload(open.device, mesh));
    });
    Comparison comparison(open, buffers, transform, fittingSolidRule(record.mesh));
    const auto measure = [&](const auto& coverage, const auto& backend, SolidRule rule) {
        auto method =
            clock.run("compare", fmt::format("{} by {}", coverage.word, backend.word),
                      [&] { return comparison.measure(backend.value, coverage.value, rule); });
        if (method)
            record.comparison.push_back(std::move(*method));
    };
    for (const auto& coverage : kCoverages)
        for (const auto& backend : kBackends) {
            if (backend.value == Backend::Automatic ||
                request.comparedCoverage.value_or(coverage.value) != coverage.value)
                continue;
            measure(coverage, backend, SolidRule::Parity);
            if (coverage.value != Coverage::Solid)
                continue;
            measure(coverage, backend, SolidRule::Voted);
            measure(coverage, backend, SolidRule::FloodFill);
        }
}

} // namespace lamina::tool
