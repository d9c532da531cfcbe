#include "compare.hpp"

#include "choices.hpp"
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
    Comparison(const OpenDevice& open, const MeshBuffers& buffers, const GridTransform& transform)
        : mOpen(open)
        , mSources{buffers.view()}
        , mTransform(transform) {}

    /// A row of the table; nothing if the backend does not serve the coverage here.
    [[nodiscard]] std::optional<ComparedMethod> measure(Backend backend, Coverage coverage) {
        auto created = Voxelizer::create(mOpen.device, {.backend = backend, .coverage = coverage});
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
        return ComparedMethod{std::string(name(coverage)),
                              std::string(name(backend)),
                              times[times.size() / 2],
                              mStats.passes,
                              mStats.gridBytes,
                              bits.count(),
                              require(compare(exact(exactCoverage(coverage)), bits))};
    }

private:
    /// The exact set: triangle/voxel overlap, or crossings, decided by the overlap backend.
    const BitGrid& exact(Coverage coverage) {
        auto found = mExact.find(coverage);
        if (found == mExact.end()) {
            VoxelGrid grid = require(VoxelGrid::create(mOpen.device));
            const auto voxelizer = require(Voxelizer::create(
                mOpen.device, {.backend = Backend::Overlap, .coverage = coverage}));
            (void)require(voxelizer->voxelize(mSources, mTransform, grid));
            found = mExact.emplace(coverage, require(grid.download())).first;
        }
        return found->second;
    }

    const OpenDevice& mOpen;
    std::array<GeometrySource, 1> mSources;
    GridTransform mTransform;
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
    Comparison comparison(open, buffers, transform);
    for (const auto& coverage : kCoverages)
        for (const auto& backend : kBackends) {
            if (backend.value == Backend::Automatic ||
                request.comparedCoverage.value_or(coverage.value) != coverage.value)
                continue;
            auto method =
                clock.run("compare", fmt::format("{} by {}", coverage.word, backend.word),
                          [&] { return comparison.measure(backend.value, coverage.value); });
            if (method)
                record.comparison.push_back(std::move(*method));
        }
}

} // namespace lamina::tool
