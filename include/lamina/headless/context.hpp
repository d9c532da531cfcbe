#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lamina::headless {

/// Who makes the context.
enum class ContextApi : std::uint8_t {
    Automatic, ///< EGL, then OSMesa.
    Egl,       ///< libEGL: GPUs, and software where the driver offers it.
    OsMesa,    ///< libOSMesa: Mesa's software renderer; no driver, no device files.
};

/// The way to a display without a window system, for ContextApi::Egl.
enum class EglPlatform : std::uint8_t {
    Automatic,   ///< Each of those below, in this order.
    Device,      ///< EGL's devices: hardware first, software last.
    Surfaceless, ///< Mesa's surfaceless platform.
    Pbuffer, ///< The default display (an X server, if there is one) with a 1x1 off-screen surface.
};

/// What context to create. Defaults always work where any context does.
struct ContextDesc {
    ContextApi api = ContextApi::Automatic;
    EglPlatform eglPlatform = EglPlatform::Automatic;
    int eglDevice = -1; ///< Index in EGL's own list of devices; -1: any.
    int majorVersion = 4;
    int minorVersion = 5; ///< Core profile of at least this version.
    /// A debug context (KHR_debug messages). OSMesa has none: there GL_DEBUG_OUTPUT is switched on
    /// in an ordinary context, which Mesa's renderer honours alike.
    bool debug = false;
    std::string eglLibrary = "libEGL.so.1";       ///< File name or path, loaded at run time.
    std::string osMesaLibrary = "libOSMesa.so.8"; ///< File name or path, loaded at run time.
};

/// What create() made.
struct ContextInfo {
    ContextApi api = ContextApi::Automatic; ///< Egl or OsMesa.
    std::string kind;     ///< "EGL device 0 (software)", "EGL surfaceless", "OSMesa", ...
    std::string renderer; ///< GL_RENDERER
    std::string version;  ///< GL_VERSION
};

using GlFunction = void (*)();
/// Looks up a GL function. May return non-null for names that do not exist.
using GlLoader = GlFunction (*)(const char* name);

class NativeContext;

/// An OpenGL core context without window or window system. Move-only.
///
/// Threads: a context is current on one thread at a time and moves with doneCurrent() there and
/// makeCurrent() here. Contexts on different threads are independent. Contexts of both kinds may
/// live side by side; one of them is current on a thread, and makeCurrent() lets go of the other. A
/// host's own contexts of the other kind than this one must not be current then: Mesa's EGL and
/// OSMesa share one current context a thread below the surface.
class Context {
public:
    /// Creates a context and leaves it current on the calling thread. What was current before is
    /// let go of on success and current again after an error.
    /// Errors: InvalidArgument for a version below 3.2 (no core profile); NoContext, whose text
    /// says of each way that was tried why it failed.
    /// Cost: milliseconds to a third of a second. EGL displays stay initialised until the process
    /// ends, because others may use the same ones.
    [[nodiscard]] LAMINA_API static Result<Context> create(const ContextDesc& desc = {});

    LAMINA_API Context(Context&&) noexcept;
    LAMINA_API Context& operator=(Context&&) noexcept;
    /// Destroys the context; it must not be current on another thread. Leaves no context current if
    /// this one was, else whatever was. GL objects that live in it must be gone before.
    LAMINA_API ~Context();

    /// Makes the context current on the calling thread, where it may be already.
    /// Errors: NoContext if the API refuses, for instance because it is current on another thread.
    [[nodiscard]] LAMINA_API Result<void> makeCurrent();

    /// Leaves the calling thread without a current context, if it is this one.
    LAMINA_API void doneCurrent();

    [[nodiscard]] LAMINA_API bool isCurrent() const;

    /// The address of a GL function, callable while the context is current.
    [[nodiscard]] LAMINA_API void* getProcAddress(const char* name) const;

    /// The same as a plain function, for loaders that take one. Valid until the process ends.
    [[nodiscard]] LAMINA_API GlLoader loader() const;

    [[nodiscard]] LAMINA_API const ContextInfo& info() const;

    /// One line: kind, renderer and version.
    [[nodiscard]] LAMINA_API std::string describe() const;

    /// What create() tried in vain before it succeeded, one "way: reason" each.
    [[nodiscard]] LAMINA_API std::span<const std::string> attempts() const;

private:
    explicit Context(std::unique_ptr<NativeContext> native);

    std::unique_ptr<NativeContext> mNative;
    ContextInfo mInfo;
    std::vector<std::string> mAttempts;
};

} // namespace lamina::headless
