#include "gl_timing.hpp"

#include "gl/device_state.hpp"

#include <chrono>
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
    /// Adds the time of the last scope, which took `wallSeconds` until the GPU had finished it.
    void collect(double wallSeconds) {
        if (mQuery == 0)
            return;
        GLuint64 nanoseconds = 0;
        mGl.GetQueryObjectui64v(mQuery, GL_QUERY_RESULT, &nanoseconds);
        // llvmpipe forgets the start of some scopes and reports the time since the machine's.
        if (static_cast<double>(nanoseconds) * 1e-9 > wallSeconds)
            mWorks = false;
        mTotal += static_cast<double>(nanoseconds);
    }
    /// Sum of the scopes in seconds; nothing without a working timer: llvmpipe's sees no compute
    /// work and reports some nanoseconds.
    [[nodiscard]] std::optional<double> total() const {
        constexpr double kLeastSeconds = 1e-5;
        const double seconds = mTotal * 1e-9;
        return mWorks && seconds > kLeastSeconds ? std::optional(seconds) : std::nullopt;
    }

private:
    const GladGLContext& mGl;
    GLuint mQuery = 0;
    double mTotal = 0.0;
    bool mWorks = true;
};

} // namespace

Result<void> measure(benchmark::State& state, const Device& device,
                     const std::function<Result<void>()>& work) {
    const GladGLContext& gl = device.state()->gl;
    constexpr int kWarmUps = 2;
    Result<void> done;
    for (int i = 0; i < kWarmUps && done; ++i)
        done = work();
    gl.Finish();
    if (!done)
        return done;

    using Clock = std::chrono::steady_clock;
    GpuTimer timer(gl);
    for ([[maybe_unused]] auto iteration : state) {
        const auto start = Clock::now();
        timer.begin();
        done = work();
        timer.end();
        gl.Finish();
        timer.collect(std::chrono::duration<double>(Clock::now() - start).count());
        if (!done)
            state.SkipWithError(done.error().text.c_str());
    }
    if (const auto seconds = timer.total())
        state.counters["GPU ms"] =
            benchmark::Counter(*seconds * 1e3, benchmark::Counter::kAvgIterations);
    return done;
}

} // namespace lamina::bench
