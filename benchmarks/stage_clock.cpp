#include "stage_clock.hpp"

#include <GL/glcorearb.h>

#include <chrono>

namespace lamina::bench {
namespace {

/// GL functions have no room for an argument of ours.
StageClock* theClock = nullptr;
PFNGLPUSHDEBUGGROUPPROC thePush = nullptr;
PFNGLPOPDEBUGGROUPPROC thePop = nullptr;

void APIENTRY pushGroup(GLenum source, GLuint id, GLsizei length, const GLchar* message) {
    thePush(source, id, length, message);
    theClock->push(length < 0 ? std::string_view(message)
                              : std::string_view(message, static_cast<std::size_t>(length)));
}

void APIENTRY popGroup() {
    theClock->pop();
    thePop();
}

} // namespace

StageClock::StageClock(std::function<void*(const char*)> load)
    : mLoad(std::move(load)) {
    mFinish = reinterpret_cast<PFNGLFINISHPROC>(mLoad("glFinish"));
    thePush = reinterpret_cast<PFNGLPUSHDEBUGGROUPPROC>(mLoad("glPushDebugGroup"));
    thePop = reinterpret_cast<PFNGLPOPDEBUGGROUPPROC>(mLoad("glPopDebugGroup"));
    theClock = this;
}

StageClock::~StageClock() {
    theClock = nullptr;
}

std::function<void*(const char*)> StageClock::loader() {
    return [load = mLoad](const char* name) -> void* {
        if (std::string_view(name) == "glPushDebugGroup")
            return reinterpret_cast<void*>(&pushGroup);
        if (std::string_view(name) == "glPopDebugGroup")
            return reinterpret_cast<void*>(&popGroup);
        return load(name);
    };
}

double StageClock::milliseconds(std::string_view group) const {
    const auto found = mTimes.find(group);
    return found == mTimes.end() ? 0.0 : found->second;
}

double StageClock::now() const {
    mFinish();
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void StageClock::push(std::string_view group) {
    mOpen.push_back({std::string(group), now()});
}

void StageClock::pop() {
    mTimes[mOpen.back().group] += now() - mOpen.back().start;
    mOpen.pop_back();
}

} // namespace lamina::bench
