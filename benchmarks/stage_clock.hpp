#pragma once

#include <lamina/gl/device.hpp>

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lamina::bench {

/// Times the stages of an effect: what Lamina does within each of its debug groups, waiting for the
/// GL before and after. One at a time in a process.
class StageClock {
public:
    /// load: the context's.
    explicit StageClock(std::function<void*(const char*)> load);
    ~StageClock();
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;

    /// What the device to time must be made with.
    [[nodiscard]] std::function<void*(const char*)> loader();

    /// Forgets all times.
    void reset() { mTimes.clear(); }
    /// Wall milliseconds in groups of this name since reset(), those of the groups in them
    /// included.
    [[nodiscard]] double milliseconds(std::string_view group) const;

    void push(std::string_view group);
    void pop();

private:
    struct Open {
        std::string group;
        double start = 0.0;
    };

    [[nodiscard]] double now() const;

    std::function<void*(const char*)> mLoad;
    void (*mFinish)() = nullptr;
    std::vector<Open> mOpen;
    std::map<std::string, double, std::less<>> mTimes;
};

} // namespace lamina::bench
