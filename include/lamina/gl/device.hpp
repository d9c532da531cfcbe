#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace lamina {

/// Internals. A host with a global object `gl` of its own names what it uses (`using
/// lamina::Device;`) rather than all of lamina: the two names would be ambiguous.
namespace gl {
struct DeviceState;
}

/// The host's way to look up GL functions. Wraps eglGetProcAddress, glfwGetProcAddress,
/// SDL_GL_GetProcAddress, OSMesaGetProcAddress or any callable from `const char*` to a pointer.
class GetProcAddress {
public:
    template<class Loader>
    requires(!std::is_same_v<std::remove_cvref_t<Loader>, GetProcAddress> &&
             std::is_invocable_v<Loader&, const char*>) GetProcAddress(Loader loader)
        : mLoad([loader = std::move(loader)](const char* name) mutable {
            return reinterpret_cast<void*>(loader(name));
        }) {}

    [[nodiscard]] void* operator()(const char* name) const { return mLoad(name); }

private:
    std::function<void*(const char*)> mLoad;
};

enum class MessageSeverity : std::uint8_t { Info, Warning };

/// Something a developer may want to know: why a backend was chosen, a shader compiler's warnings.
struct Message {
    MessageSeverity severity = MessageSeverity::Info;
    std::string_view text; ///< Valid during the callback.
};

struct DeviceDesc {
    /// Most bytes of GL memory that objects of this device may hold together; 0: no limit.
    std::uint64_t memoryBudgetBytes = 0;
    /// A shader root (the repository's shaders/) whose files replace the embedded ones, for shader
    /// development; empty: embedded shaders only. Read when a program is first built.
    std::filesystem::path shaderOverrideDirectory;
    /// Receives messages, on the thread of the call that causes them; may be empty. Lamina never
    /// installs a GL debug callback: the host's stays in place.
    std::function<void(const Message&)> message;
};

/// What the GL implementation can do.
struct DeviceLimits {
    std::uint32_t maxTextureSize = 0;               ///< Columns in x or y.
    std::uint32_t maxArrayTextureLayers = 0;        ///< Groups of 128 slices.
    std::uint32_t maxViewportWidth = 0;             ///< Pixels.
    std::uint32_t maxViewportHeight = 0;            ///< Pixels.
    std::uint32_t maxDrawBuffers = 0;               ///< Render targets of one pass.
    std::uint32_t maxVertexAttribStride = 0;        ///< Bytes.
    std::uint32_t maxUniformBufferBindings = 0;     ///< Binding points.
    std::uint32_t maxCombinedTextureUnits = 0;      ///< Texture units.
    std::uint32_t uniformBufferOffsetAlignment = 1; ///< Bytes.
    std::uint32_t maxTextureBufferTexels = 0;       ///< Texels of a texel buffer.
    std::uint64_t maxStorageBlockBytes = 0; ///< Bytes of a storage buffer that a shader sees.
    std::uint32_t storageBufferOffsetAlignment = 1; ///< Bytes.
    std::uint32_t subpixelBits = 0; ///< Fraction bits of rasterized window coordinates.
};

/// Which implementation it is.
struct DeviceInfo {
    std::string vendor;
    std::string renderer;
    std::string version;
    int majorVersion = 0;
    int minorVersion = 0;
    bool isSoftware = false; ///< Rasterizes on the CPU (llvmpipe, softpipe, swrast, SwiftShader).
};

/// The engine's GL context as Lamina sees it: its functions, limits, programs and memory budget.
///
/// One device per context; several devices live side by side. Use a device, and destroy it and
/// every object made from it, on the thread where its context is current. Move-only.
///
/// A moved-from device, grid or other object may be destroyed or assigned to, nothing else.
///
/// What every call leaves as it was: all GL state it touches, put back before it returns, except
/// where its documentation says otherwise (bind()). What it cannot hide from: active occlusion,
/// primitive and timer queries count its draws; do not call inside glBeginConditionalRender. Calls
/// that allocate GL memory take a GL error that the host left pending off the queue, with a
/// message.
class LAMINA_API Device {
public:
    /// Looks at the context current on this thread. `load` is used during this call only.
    /// Errors: NoContext (nothing current), UnsupportedDevice (older than OpenGL 4.5, or OpenGL
    /// ES). GL: creates nothing, changes nothing.
    [[nodiscard]] static Result<Device> fromCurrentContext(const GetProcAddress& load,
                                                           const DeviceDesc& desc = {});

    Device(Device&&) noexcept;
    Device& operator=(Device&&) noexcept;
    ~Device();

    [[nodiscard]] const DeviceInfo& info() const;
    [[nodiscard]] const DeviceLimits& limits() const;

    /// Bytes of GL buffers and textures that live objects of this device hold.
    [[nodiscard]] std::uint64_t allocatedBytes() const;
    /// Replaces DeviceDesc::memoryBudgetBytes; objects that exist stay.
    void setMemoryBudget(std::uint64_t bytes);

    /// Building blocks for Lamina's own modules; not part of the stable API.
    [[nodiscard]] const std::shared_ptr<gl::DeviceState>& state() const { return mState; }

private:
    explicit Device(std::shared_ptr<gl::DeviceState> state);
    std::shared_ptr<gl::DeviceState> mState;
};

} // namespace lamina
