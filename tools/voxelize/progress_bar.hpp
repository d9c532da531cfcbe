#pragma once

#include <chrono>
#include <string>

namespace lamina::tool {

/// One line on standard error that says what is being done; nothing unless that is a terminal.
class ProgressBar {
public:
    /// `wanted` false: never shown.
    explicit ProgressBar(bool wanted);
    ~ProgressBar() { clear(); }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void begin(const std::string& stage);
    /// `fraction` of the stage in [0,1]. Redraws at most some 20 times a second.
    void update(double fraction);
    /// Wipes the line, so that other text can be printed.
    void clear();

private:
    void draw(double fraction);

    using Clock = std::chrono::steady_clock;
    bool mShown = false;
    bool mOnScreen = false;
    std::string mStage;
    Clock::time_point mLastDraw;
};

} // namespace lamina::tool
