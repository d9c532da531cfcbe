#include "table_reporter.hpp"

#include <cstdio>

namespace lamina::bench {
namespace {

double counter(const benchmark::BenchmarkReporter::Run& run, const char* name) {
    const auto found = run.counters.find(name);
    return found == run.counters.end() ? 0.0 : found->second.value;
}

std::string number(double value, int decimals) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

std::string milliseconds(double value) {
    return number(value, value < 100.0 ? 2 : 0);
}

/// What a method does not report is "-", not 0.
std::string rate(const benchmark::BenchmarkReporter::Run& run, const char* name, double scale,
                 int decimals) {
    return run.counters.contains(name) ? number(counter(run, name) * scale, decimals) : "-";
}

} // namespace

bool TableReporter::ReportContext(const Context& context) {
    PrintBasicContext(&GetOutputStream(), context);
    return true;
}

void TableReporter::printRow(const std::string& method, const Run& run) {
    const double time = run.GetAdjustedRealTime();
    if (mFirstTime == 0.0)
        mFirstTime = time;
    const double gpu = counter(run, "GPU ms");
    std::printf("  %-38s %9s %9s %9s %8.2f %9s %10s %11s %9.1f\n", method.c_str(),
                milliseconds(time).c_str(), milliseconds(run.GetAdjustedCPUTime()).c_str(),
                gpu > 0.0 ? milliseconds(gpu).c_str() : "-", time / mFirstTime,
                rate(run, "triangles/s", 1e-6, 2).c_str(), rate(run, "voxels/s", 1e-6, 1).c_str(),
                rate(run, "set voxels", 1.0, 0).c_str(), counter(run, "bytes") / 1048576.0);
}

void TableReporter::ReportRuns(const std::vector<Run>& runs) {
    for (const Run& run : runs) {
        // "mesh/resolution/method"
        const std::string name =
            run.run_name.function_name +
            (run.run_type == Run::RT_Aggregate ? " " + run.aggregate_name : std::string());
        const std::size_t cut = name.rfind('/');
        const std::string block = name.substr(0, cut);
        const std::string method = name.substr(cut + 1);
        if (block != mBlock) {
            mBlock = block;
            mFirstTime = 0.0;
            std::printf("\n%s, %.0f triangles\n  %-38s %9s %9s %9s %8s %9s %10s %11s %9s\n",
                        block.c_str(), counter(run, "triangles"), "", "wall ms", "CPU ms", "GPU ms",
                        "relative", "Mtri/s", "Mvoxel/s", "voxels set", "MiB");
        }
        if (run.error_occurred) {
            mFailed = true;
            std::printf("  %-38s failed: %s\n", method.c_str(), run.error_message.c_str());
        } else {
            printRow(method, run);
        }
    }
    std::fflush(stdout);
}

} // namespace lamina::bench
