#include <lamina/headless/context.hpp>

#include "headless/native_context.hpp"

#include <utility>

namespace lamina::headless {
namespace {

constexpr unsigned kGlRenderer = 0x1F01;
constexpr unsigned kGlVersion = 0x1F02;
constexpr unsigned kGlMajorVersion = 0x821B;
constexpr unsigned kGlMinorVersion = 0x821C;
constexpr unsigned kGlContextProfileMask = 0x9126;
constexpr int kGlContextCoreProfileBit = 1;

/// The context of ours that this thread made current last; the host may have replaced it since.
thread_local NativeContext* tLatest = nullptr;

NativeContext* currentOfThread() {
    return tLatest && tLatest->isCurrent() ? tLatest : nullptr;
}

/// Mesa's EGL and OSMesa share the thread's current context below their own: creating, binding or
/// destroying one while the other's is current corrupts both.
NativeContext* releaseCurrent() {
    NativeContext* current = currentOfThread();
    if (current)
        current->release();
    tLatest = nullptr;
    return current;
}

std::string bindOf(NativeContext& context) {
    std::string reason = context.bind();
    if (reason.empty())
        tLatest = &context;
    return reason;
}

std::string glString(const NativeContext& native, unsigned name) {
    const auto getString =
        reinterpret_cast<const unsigned char* (*)(unsigned)>(native.loader()("glGetString"));
    const unsigned char* text = getString ? getString(name) : nullptr;
    return text ? reinterpret_cast<const char*>(text) : "unknown";
}

std::string versionText(int major, int minor) {
    return std::to_string(major) + "." + std::to_string(minor);
}

Error noContext(const ContextDesc& desc, const Attempts& attempts) {
    std::string text = "create context: expected OpenGL " +
                       versionText(desc.majorVersion, desc.minorVersion) + " core from " +
                       (desc.api == ContextApi::Egl      ? "EGL"
                        : desc.api == ContextApi::OsMesa ? "OSMesa"
                                                         : "EGL or OSMesa") +
                       ", found none";
    for (std::size_t i = 0; i < attempts.size(); ++i)
        text += (i == 0 ? ": " : "; ") + attempts[i];
    return {ErrorCode::NoContext,
            text + "; install a driver of that version (software: libegl1 with libgl1-mesa-dri, or "
                   "libosmesa6)"};
}

} // namespace

std::string checkVersion(const NativeContext& native, const ContextDesc& desc) {
    const auto getInteger =
        reinterpret_cast<void (*)(unsigned, int*)>(native.loader()("glGetIntegerv"));
    if (!getInteger)
        return "no glGetIntegerv";
    int major = 0;
    int minor = 0;
    int profile = 0;
    getInteger(kGlMajorVersion, &major);
    getInteger(kGlMinorVersion, &minor);
    getInteger(kGlContextProfileMask, &profile);
    if (std::pair(major, minor) < std::pair(desc.majorVersion, desc.minorVersion))
        return "found OpenGL " + versionText(major, minor) + " only";
    if (!(profile & kGlContextCoreProfileBit))
        return "found no core profile";
    return {};
}

Result<Context> Context::create(const ContextDesc& desc) {
    if (std::pair(desc.majorVersion, desc.minorVersion) < std::pair(3, 2))
        return Error{ErrorCode::InvalidArgument,
                     "create context: expected version 3.2 or later (core profiles), found " +
                         versionText(desc.majorVersion, desc.minorVersion)};
    NativeContext* before = releaseCurrent();
    Attempts attempts;
    std::unique_ptr<NativeContext> native;
    if (desc.api != ContextApi::OsMesa)
        native = createEgl(desc, attempts);
    if (!native && desc.api != ContextApi::Egl)
        native = createOsMesa(desc, attempts);
    if (!native) {
        if (before)
            bindOf(*before);
        return noContext(desc, attempts);
    }
    tLatest = native.get();
    Context context(std::move(native));
    context.mAttempts = std::move(attempts);
    return context;
}

Context::Context(std::unique_ptr<NativeContext> native)
    : mNative(std::move(native)) {
    mInfo = {mNative->api, mNative->kind, glString(*mNative, kGlRenderer),
             glString(*mNative, kGlVersion)};
}

Context::Context(Context&&) noexcept = default;

Context& Context::operator=(Context&& other) noexcept {
    Context old(std::move(*this));
    mNative = std::move(other.mNative);
    mInfo = std::move(other.mInfo);
    mAttempts = std::move(other.mAttempts);
    return *this;
}

Context::~Context() {
    if (!mNative)
        return;
    NativeContext* current = releaseCurrent();
    const bool wasCurrent = current == mNative.get();
    mNative.reset();
    if (current && !wasCurrent)
        bindOf(*current);
}

Result<void> Context::makeCurrent() {
    NativeContext* before = currentOfThread();
    if (before == mNative.get())
        return {};
    releaseCurrent();
    const std::string reason = bindOf(*mNative);
    if (reason.empty())
        return {};
    if (before)
        bindOf(*before);
    return Error{ErrorCode::NoContext, "make context current: expected " + mInfo.kind +
                                           " to be free for this thread, found: " + reason +
                                           "; call doneCurrent() where it is current"};
}

void Context::doneCurrent() {
    if (isCurrent())
        releaseCurrent();
}

bool Context::isCurrent() const {
    return mNative && currentOfThread() == mNative.get();
}

void* Context::getProcAddress(const char* name) const {
    return reinterpret_cast<void*>(mNative->loader()(name));
}

GlLoader Context::loader() const {
    return mNative->loader();
}

const ContextInfo& Context::info() const {
    return mInfo;
}

std::string Context::describe() const {
    return mInfo.kind + ", " + mInfo.renderer + ", OpenGL " + mInfo.version;
}

std::span<const std::string> Context::attempts() const {
    return mAttempts;
}

} // namespace lamina::headless
