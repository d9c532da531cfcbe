#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace lamina::bench {

/// Google Benchmark's results as a table for people: a block for each mesh and resolution, a line
/// for each method. `CPU ms` sums all threads of the process, software GL's too; `relative` is a
/// method's wall time over that of its block's first line.
class TableReporter final : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context& context) override;
    void ReportRuns(const std::vector<Run>& runs) override;

    /// A benchmark could not run.
    [[nodiscard]] bool failed() const { return mFailed; }

private:
    void printRow(const std::string& method, const Run& run);

    std::string mBlock;
    double mFirstTime = 0.0;
    bool mFailed = false;
};

} // namespace lamina::bench
