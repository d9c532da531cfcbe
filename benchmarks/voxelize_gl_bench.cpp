#include "bench_case.hpp"

#include "gl/device_state.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <optional>

namespace lamina::bench {
namespace {

/// GL time of a scope between begin() and end(), where the implementation has a timer.
class GpuTimer {
public:
    explicit GpuTimer(const GladGLContext& gl)
        : mGl(gl) {
        GLint bits = 0;
        mGl.GetQueryiv(GL_TIME_ELAPSED, GL_QUERY_COUNTER_BITS, &bits);
        if (bits > 0)
            mGl.GenQueries(1, &mQuery);
    }
    ~GpuTimer() { mGl.DeleteQueries(1, &mQuery); }
    GpuTimer(const GpuTimer&) = delete;
    GpuTimer& operator=(const GpuTimer&) = delete;

    void begin() const {
        if (mQuery != 0)
            mGl.BeginQuery(GL_TIME_ELAPSED, mQuery);
    }
    void end() const {
        if (mQuery != 0)
            mGl.EndQuery(GL_TIME_ELAPSED);
    }
    /// Adds the time of the last scope; the GPU must have finished it.
    void collect() {
        if (mQuery == 0)
            return;
        GLuint64 nanoseconds = 0;
        mGl.GetQueryObjectui64v(mQuery, GL_QUERY_RESULT, &nanoseconds);
        mTotal += static_cast<double>(nanoseconds);
    }
    /// Sum of the scopes in seconds; nothing without a working timer: llvmpipe's sees no compute
    /// work and reports some nanoseconds.
    [[nodiscard]] std::optional<double> total() const {
        constexpr double kLeastSeconds = 1e-5;
        const double seconds = mTotal * 1e-9;
        return seconds > kLeastSeconds ? std::optional(seconds) : std::nullopt;
    }

private:
    const GladGLContext& mGl;
    GLuint mQuery = 0;
    double mTotal = 0.0;
};

/// Voxelizes again and again, waiting for the GL after each; the programs are warm by then.
Result<void> run(benchmark::State& state, const Device& device, const TriangleMesh& mesh,
                 const GridTransform& transform, Coverage coverage) {
    const GladGLContext& gl = device.state()->gl;
    auto voxelizer = Voxelizer::create(device, {.coverage = coverage});
    if (!voxelizer)
        return voxelizer.error();
    auto buffers = MeshBuffers::upload(device, mesh);
    if (!buffers)
        return buffers.error();
    auto grid = VoxelGrid::create(device);
    if (!grid)
        return grid.error();
    const GeometrySource sources[] = {buffers->view()};

    constexpr int kWarmUps = 2;
    Result<VoxelizeStats> stats = VoxelizeStats{};
    for (int i = 0; i < kWarmUps && stats; ++i)
        stats = (*voxelizer)->voxelize(sources, transform, *grid);
    if (!stats)
        return stats.error();
    gl.Finish();

    GpuTimer timer(gl);
    for ([[maybe_unused]] auto iteration : state) {
        timer.begin();
        stats = (*voxelizer)->voxelize(sources, transform, *grid);
        timer.end();
        gl.Finish();
        timer.collect();
    }
    if (!stats)
        return stats.error();

    auto bits = grid->download();
    if (!bits)
        return bits.error();
    report(state, mesh, transform, bits->count(), grid->gpuBytes());
    state.counters["passes"] = stats->passes;
    if (const auto seconds = timer.total())
        state.counters["GPU ms"] =
            benchmark::Counter(*seconds * 1e3, benchmark::Counter::kAvgIterations);
    return {};
}

void registerRun(const Device& device, const std::string& name, std::shared_ptr<NamedMesh> mesh,
                 Coverage coverage,
                 std::function<Result<GridTransform>(const TriangleMesh&)> makeGrid) {
    const auto body = [=, &device](benchmark::State& state) {
        Result<void> done;
        if (auto loaded = mesh->get(); !loaded)
            done = loaded.error();
        else if (auto transform = makeGrid(**loaded); !transform)
            done = transform.error();
        else
            done = run(state, device, **loaded, *transform, coverage);
        if (!done)
            state.SkipWithError(done.error().text.c_str());
    };
    benchmark::RegisterBenchmark(name.c_str(), body)
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
}

} // namespace

void registerVoxelizers(const Device& device, const Case& what) {
    struct Row {
        const char* name;
        Coverage coverage;
    };
    for (const Row& row :
         {Row{"slicemap filled", Coverage::Filled}, Row{"slicemap sampled", Coverage::Sampled},
          Row{"overlap conservative", Coverage::Conservative},
          Row{"overlap separating6", Coverage::Separating6}, Row{"overlap solid", Coverage::Solid}})
        registerRun(device, what.describe() + "/lamina " + row.name, what.mesh, row.coverage,
                    [resolution = what.resolution](const TriangleMesh& mesh) {
                        return benchGrid(mesh, resolution);
                    });
}

void registerSlicemapPasses(const Device& device, const std::shared_ptr<NamedMesh>& mesh) {
    constexpr std::uint32_t kColumns = 512;
    for (const std::uint32_t slices : {128u, 256u, 512u, 1024u})
        registerRun(device,
                    mesh->name + "/512x512 columns/lamina slicemap filled, " +
                        std::to_string(slices) + " slices",
                    mesh, Coverage::Filled, [slices](const TriangleMesh& loaded) {
                        return GridTransform::box(loaded.bounds(), {kColumns, kColumns, slices});
                    });
}

} // namespace lamina::bench
