#include "headless/egl_display.hpp"
#include "headless/egl_functions.hpp"
#include "headless/native_context.hpp"

#include <array>

namespace lamina::headless {
namespace {

class EglContext final : public NativeContext {
public:
    EglContext(std::string kind, const Egl& egl, EGLDisplay display)
        : NativeContext(ContextApi::Egl, std::move(kind))
        , mEgl(egl)
        , mDisplay(display) {}
    ~EglContext() override {
        if (mContext != EGL_NO_CONTEXT)
            mEgl.destroyContext(mDisplay, mContext);
        if (mSurface != EGL_NO_SURFACE)
            mEgl.destroySurface(mDisplay, mSurface);
    }

    /// Creates the context on an initialised display. Returns why not, or nothing.
    std::string create(const ContextDesc& desc, bool isEgl15, bool needsPbuffer);

    std::string bind() override {
        if (mEgl.makeCurrent(mDisplay, mSurface, mSurface, mContext))
            return {};
        return "eglMakeCurrent failed (" + mEgl.errorName() + ")";
    }
    void release() override {
        mEgl.makeCurrent(mDisplay, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    [[nodiscard]] bool isCurrent() const override { return mEgl.getCurrentContext() == mContext; }
    [[nodiscard]] GlLoader loader() const override { return mEgl.getProcAddress; }

private:
    std::string createPbuffer(EGLConfig& config);

    Egl mEgl;
    EGLDisplay mDisplay;
    EGLContext mContext = EGL_NO_CONTEXT;
    EGLSurface mSurface = EGL_NO_SURFACE;
};

std::string EglContext::create(const ContextDesc& desc, bool isEgl15, bool needsPbuffer) {
    const std::string_view extensions = mEgl.extensions(mDisplay);
    const bool hasCreateContext = hasExtension(extensions, "EGL_KHR_create_context");
    if (!isEgl15 && !hasCreateContext)
        return "the display has neither EGL 1.5 nor EGL_KHR_create_context";

    EGLConfig config = EGL_NO_CONFIG_KHR;
    const bool canDoWithout = hasExtension(extensions, "EGL_KHR_no_config_context") &&
                              hasExtension(extensions, "EGL_KHR_surfaceless_context");
    if (needsPbuffer || !canDoWithout) {
        if (std::string reason = createPbuffer(config); !reason.empty())
            return reason;
    }
    std::vector<EGLint> attributes = {
        EGL_CONTEXT_MAJOR_VERSION,       desc.majorVersion,
        EGL_CONTEXT_MINOR_VERSION,       desc.minorVersion,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
    if (desc.debug && isEgl15)
        attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
    else if (desc.debug)
        attributes.insert(attributes.end(),
                          {EGL_CONTEXT_FLAGS_KHR, EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR});
    attributes.push_back(EGL_NONE);
    mContext = mEgl.createContext(mDisplay, config, EGL_NO_CONTEXT, attributes.data());
    if (mContext == EGL_NO_CONTEXT)
        return "eglCreateContext failed (" + mEgl.errorName() + ")";
    return {};
}

std::string EglContext::createPbuffer(EGLConfig& config) {
    const std::array<EGLint, 11> wanted = {EGL_SURFACE_TYPE,
                                           EGL_PBUFFER_BIT,
                                           EGL_RENDERABLE_TYPE,
                                           EGL_OPENGL_BIT,
                                           EGL_RED_SIZE,
                                           8,
                                           EGL_GREEN_SIZE,
                                           8,
                                           EGL_BLUE_SIZE,
                                           8,
                                           EGL_NONE};
    EGLint count = 0;
    if (!mEgl.chooseConfig(mDisplay, wanted.data(), &config, 1, &count))
        return "eglChooseConfig failed (" + mEgl.errorName() + ")";
    if (count == 0)
        return "no EGL config for OpenGL and pbuffers";
    const std::array<EGLint, 5> size = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    mSurface = mEgl.createPbufferSurface(mDisplay, config, size.data());
    if (mSurface == EGL_NO_SURFACE)
        return "eglCreatePbufferSurface failed (" + mEgl.errorName() + ")";
    return {};
}

/// Puts back what the host had current and its choice of API.
class EglThreadState {
public:
    explicit EglThreadState(const Egl& egl)
        : mEgl(egl)
        , mApi(egl.queryApi())
        , mDisplay(egl.getCurrentDisplay())
        , mContext(egl.getCurrentContext())
        , mDraw(egl.getCurrentSurface(EGL_DRAW))
        , mRead(egl.getCurrentSurface(EGL_READ)) {}

    void restoreApi() const { mEgl.bindApi(mApi); }
    void restoreCurrent() const {
        if (mContext != EGL_NO_CONTEXT && mEgl.getCurrentContext() != mContext)
            mEgl.makeCurrent(mDisplay, mDraw, mRead, mContext);
    }

private:
    const Egl& mEgl;
    EGLenum mApi;
    EGLDisplay mDisplay;
    EGLContext mContext;
    EGLSurface mDraw;
    EGLSurface mRead;
};

/// Returns why the candidate does not serve `desc`, or nothing with `result` set and current.
std::string tryCandidate(const Egl& egl, const ContextDesc& desc, const DisplayCandidate& candidate,
                         std::unique_ptr<NativeContext>& result) {
    const EGLDisplay display = candidate.open();
    if (display == EGL_NO_DISPLAY)
        return "no such display (" + egl.errorName() + ")";
    EGLint major = 0;
    EGLint minor = 0;
    if (!egl.initialize(display, &major, &minor))
        return "eglInitialize failed (" + egl.errorName() + ")";
    if (!egl.bindApi(EGL_OPENGL_API))
        return "the driver has no OpenGL, perhaps OpenGL ES only (" + egl.errorName() + ")";
    const bool isEgl15 = major > 1 || (major == 1 && minor >= 5);
    auto context = std::make_unique<EglContext>(candidate.kind, egl, display);
    if (std::string reason = context->create(desc, isEgl15, candidate.needsPbuffer);
        !reason.empty())
        return reason;
    if (std::string reason = context->bind(); !reason.empty())
        return reason;
    if (std::string reason = checkVersion(*context, desc); !reason.empty()) {
        context->release();
        return reason;
    }
    result = std::move(context);
    return {};
}

} // namespace

std::unique_ptr<NativeContext> createEgl(const ContextDesc& desc, Attempts& attempts) {
    const DynamicLibrary library(desc.eglLibrary);
    Egl egl{};
    if (!library) {
        attempts.push_back("EGL: " + library.error());
        return nullptr;
    }
    if (!egl.load(library)) {
        attempts.push_back("EGL: " + desc.eglLibrary + " lacks functions of EGL 1.4");
        return nullptr;
    }
    const EglThreadState before(egl);
    std::unique_ptr<NativeContext> context;
    for (const DisplayCandidate& candidate : listDisplays(egl, desc, attempts)) {
        const std::string reason = tryCandidate(egl, desc, candidate, context);
        if (context)
            break;
        attempts.push_back(candidate.kind + ": " + reason);
    }
    before.restoreApi();
    if (!context)
        before.restoreCurrent();
    return context;
}

} // namespace lamina::headless
