#include "area_light/stage_timers.hpp"

#include <algorithm>

namespace lamina {

StageTimers::StageTimers(std::shared_ptr<gl::DeviceState> device, bool isOn)
    : mDevice(std::move(device))
    , mIsOn(isOn)
    , mWaits(mDevice->info.isSoftware) {
    if (!mIsOn || mWaits)
        return;
    for (Frame& frame : mFrames)
        for (Stage& stage : frame) {
            stage.begin = gl::Query::create(mDevice, "lamina area light", GL_TIMESTAMP);
            stage.end = gl::Query::create(mDevice, "lamina area light", GL_TIMESTAMP);
        }
}

void StageTimers::beginFrame() {
    if (!mIsOn)
        return;
    if (mWaits) {
        mLatest = {};
        return;
    }
    mCurrent = (mCurrent + 1) % kFrames;
    // A frame whose times still have not come is given up.
    collect(mFrames[mCurrent]);
    for (Stage& stage : mFrames[mCurrent])
        stage.isUsed = false;
}

bool StageTimers::collect(Frame& frame) {
    const GladGLContext& gl = mDevice->gl;
    if (std::ranges::none_of(frame, &Stage::isUsed))
        return false;
    AreaLightTimes times{};
    for (std::size_t i = 0; i < kAreaLightStageCount; ++i) {
        const Stage& stage = frame[i];
        if (!stage.isUsed)
            continue;
        GLint available = GL_FALSE;
        gl.GetQueryObjectiv(stage.end.id(), GL_QUERY_RESULT_AVAILABLE, &available);
        if (!available)
            return false;
        GLuint64 begin = 0;
        GLuint64 end = 0;
        gl.GetQueryObjectui64v(stage.begin.id(), GL_QUERY_RESULT, &begin);
        gl.GetQueryObjectui64v(stage.end.id(), GL_QUERY_RESULT, &end);
        times[i] = end > begin ? 1e-6 * static_cast<double>(end - begin) : 0.0;
    }
    mLatest = times;
    return true;
}

const AreaLightTimes& StageTimers::latest() {
    if (mIsOn && !mWaits)
        for (std::size_t age = 0; age < kFrames; ++age)
            if (collect(mFrames[(mCurrent + kFrames - age) % kFrames]))
                break;
    return mLatest;
}

StageTimers::Scope::Scope(StageTimers& timers, AreaLightStage stage)
    : mTimers(timers)
    , mStage(static_cast<std::size_t>(stage)) {
    if (!mTimers.mIsOn)
        return;
    const GladGLContext& gl = mTimers.mDevice->gl;
    if (mTimers.mWaits) {
        gl.Finish();
        mStart = std::chrono::steady_clock::now();
    } else {
        gl.QueryCounter(mTimers.mFrames[mTimers.mCurrent][mStage].begin.id(), GL_TIMESTAMP);
    }
}

StageTimers::Scope::~Scope() {
    if (!mTimers.mIsOn)
        return;
    const GladGLContext& gl = mTimers.mDevice->gl;
    if (mTimers.mWaits) {
        gl.Finish();
        const std::chrono::duration<double, std::milli> passed =
            std::chrono::steady_clock::now() - mStart;
        mTimers.mLatest[mStage] = passed.count();
        return;
    }
    Stage& stage = mTimers.mFrames[mTimers.mCurrent][mStage];
    gl.QueryCounter(stage.end.id(), GL_TIMESTAMP);
    stage.isUsed = true;
}

} // namespace lamina
