#include "progress_bar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <unistd.h>

namespace lamina::tool {
namespace {

constexpr int kBarWidth = 24;
constexpr auto kRedrawInterval = std::chrono::milliseconds(50);

bool canRedrawLines() {
    const char* terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && (!terminal || std::string_view(terminal) != "dumb");
}

} // namespace

ProgressBar::ProgressBar(bool wanted)
    : mShown(wanted && canRedrawLines()) {}

void ProgressBar::begin(const std::string& stage) {
    if (!mShown)
        return;
    mStage = stage;
    draw(0.0);
}

void ProgressBar::update(double fraction) {
    if (mShown && Clock::now() - mLastDraw >= kRedrawInterval)
        draw(fraction);
}

void ProgressBar::clear() {
    if (!mOnScreen)
        return;
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
    mOnScreen = false;
}

void ProgressBar::draw(double fraction) {
    const double share = std::clamp(fraction, 0.0, 1.0);
    const int filled = static_cast<int>(share * kBarWidth);
    fmt::print(stderr, "\r\x1b[K[{:#<{}}{:.<{}}] {:3.0f} %  {}", "", filled, "", kBarWidth - filled,
               100.0 * share, mStage);
    std::fflush(stderr);
    mOnScreen = true;
    mLastDraw = Clock::now();
}

} // namespace lamina::tool
