#pragma once

#include "progress_bar.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace lamina::tool {

class Stopwatch {
public:
    [[nodiscard]] double milliseconds() const {
        return std::chrono::duration<double, std::milli>(Clock::now() - mStart).count();
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point mStart = Clock::now();
};

struct StageTime {
    std::string name;
    double milliseconds = 0.0;
};

/// Runs the stages of the work: shows each on the progress bar and times it.
class StageClock {
public:
    explicit StageClock(bool showProgress)
        : mBar(showProgress) {}

    /// What `work` returns. `title` is for the progress bar; times of one `name` are added up.
    template<class Work>
    auto run(const std::string& name, const std::string& title, Work&& work) {
        mBar.begin(title);
        const Recorder recorder{*this, name};
        return std::forward<Work>(work)();
    }

    /// Share of the running stage that is done, in [0,1].
    void progress(double fraction) { mBar.update(fraction); }

    /// Wipes the progress bar, before other text is printed.
    void finish() { mBar.clear(); }
    /// Of the stages that ended, in order of their first run.
    [[nodiscard]] const std::vector<StageTime>& times() const { return mTimes; }
    /// Since this object was made.
    [[nodiscard]] double totalMilliseconds() const { return mTotal.milliseconds(); }

private:
    struct Recorder {
        StageClock& clock;
        const std::string& name;
        Stopwatch watch = {};
        ~Recorder() { clock.add(name, watch.milliseconds()); }
    };

    void add(const std::string& name, double milliseconds) {
        for (StageTime& time : mTimes)
            if (time.name == name) {
                time.milliseconds += milliseconds;
                return;
            }
        mTimes.push_back({name, milliseconds});
    }

    ProgressBar mBar;
    std::vector<StageTime> mTimes;
    Stopwatch mTotal;
};

} // namespace lamina::tool
