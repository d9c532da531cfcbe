#pragma once

#include "gl/device_state.hpp"

#include <lamina/area_light/area_light.hpp>

#include <array>
#include <chrono>

namespace lamina {

/// GPU time stamps around the stages of a few frames. Time stamps, unlike elapsed-time queries, may
/// be taken while the host's own timer runs. Nothing here waits, but for software renderers, whose
/// timers see no compute work: there stages are waited for and the host's clock is read.
class StageTimers {
public:
    StageTimers(std::shared_ptr<gl::DeviceState> device, bool isOn);

    /// A new frame begins.
    void beginFrame();
    /// Times of the latest frame that has arrived.
    [[nodiscard]] const AreaLightTimes& latest();

    /// Measures a stage for as long as it lives.
    class Scope {
    public:
        Scope(StageTimers& timers, AreaLightStage stage);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        StageTimers& mTimers;
        std::size_t mStage;
        std::chrono::steady_clock::time_point mStart;
    };

private:
    struct Stage {
        gl::Query begin, end;
        bool isUsed = false;
    };
    using Frame = std::array<Stage, kAreaLightStageCount>;

    /// Did the times of a frame arrive? They are then the latest.
    bool collect(Frame& frame);

    static constexpr std::size_t kFrames = 4;
    std::shared_ptr<gl::DeviceState> mDevice;
    bool mIsOn;
    bool mWaits;
    std::array<Frame, kFrames> mFrames;
    std::size_t mCurrent = 0;
    AreaLightTimes mLatest{};
};

} // namespace lamina
