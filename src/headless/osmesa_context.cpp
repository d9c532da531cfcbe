#include "headless/dynamic_library.hpp"
#include "headless/native_context.hpp"

#include <array>

namespace lamina::headless {
namespace {

// From Mesa's osmesa.h, which distributions no longer ship with every Mesa.
using OsMesaHandle = struct OsMesaContextRecord*;
constexpr int kOsMesaFormat = 0x22;
constexpr int kOsMesaRgba = 0x1908;
constexpr int kOsMesaProfile = 0x33;
constexpr int kOsMesaCoreProfile = 0x34;
constexpr int kOsMesaMajorVersion = 0x36;
constexpr int kOsMesaMinorVersion = 0x37;

constexpr unsigned kGlUnsignedByte = 0x1401;
constexpr unsigned kGlDebugOutput = 0x92E0;

struct OsMesa {
    OsMesaHandle (*createContext)(const int* attributes, OsMesaHandle shared);
    unsigned char (*makeCurrent)(OsMesaHandle, void* buffer, unsigned type, int width, int height);
    OsMesaHandle (*currentContext)();
    void (*destroyContext)(OsMesaHandle);
    GlLoader getProcAddress;

    /// Whether all functions were found.
    bool load(const DynamicLibrary& library) {
        return library.load("OSMesaCreateContextAttribs", createContext) &&
               library.load("OSMesaMakeCurrent", makeCurrent) &&
               library.load("OSMesaGetCurrentContext", currentContext) &&
               library.load("OSMesaDestroyContext", destroyContext) &&
               library.load("OSMesaGetProcAddress", getProcAddress);
    }
};

class OsMesaContext final : public NativeContext {
public:
    OsMesaContext(const OsMesa& functions, OsMesaHandle handle)
        : NativeContext(ContextApi::OsMesa, "OSMesa")
        , mFunctions(functions)
        , mHandle(handle) {}
    ~OsMesaContext() override { mFunctions.destroyContext(mHandle); }

    std::string bind() override {
        if (mFunctions.makeCurrent(mHandle, mPixel.data(), kGlUnsignedByte, 1, 1))
            return {};
        return "OSMesaMakeCurrent failed";
    }
    void release() override { mFunctions.makeCurrent(nullptr, nullptr, kGlUnsignedByte, 0, 0); }
    [[nodiscard]] bool isCurrent() const override { return mFunctions.currentContext() == mHandle; }
    [[nodiscard]] GlLoader loader() const override { return mFunctions.getProcAddress; }

private:
    OsMesa mFunctions;
    OsMesaHandle mHandle;
    // OSMesa demands a colour buffer in client memory.
    alignas(16) std::array<unsigned char, 16> mPixel{};
};

void enableDebugOutput(const NativeContext& context) {
    const auto enable = reinterpret_cast<void (*)(unsigned)>(context.loader()("glEnable"));
    if (enable)
        enable(kGlDebugOutput);
}

} // namespace

std::unique_ptr<NativeContext> createOsMesa(const ContextDesc& desc, Attempts& attempts) {
    const auto fail = [&attempts](const std::string& reason) {
        attempts.push_back("OSMesa: " + reason);
        return nullptr;
    };
    const DynamicLibrary library(desc.osMesaLibrary);
    if (!library)
        return fail(library.error());
    OsMesa functions{};
    if (!functions.load(library))
        return fail(desc.osMesaLibrary + " lacks functions of OSMesa 11.2");

    const std::array<int, 9> attributes = {
        kOsMesaFormat,       kOsMesaRgba,         kOsMesaProfile,
        kOsMesaCoreProfile,  kOsMesaMajorVersion, desc.majorVersion,
        kOsMesaMinorVersion, desc.minorVersion,   0};
    const OsMesaHandle handle = functions.createContext(attributes.data(), nullptr);
    if (!handle)
        return fail("OSMesaCreateContextAttribs failed");
    auto context = std::make_unique<OsMesaContext>(functions, handle);
    if (const std::string reason = context->bind(); !reason.empty())
        return fail(reason);
    if (const std::string reason = checkVersion(*context, desc); !reason.empty()) {
        context->release();
        return fail(reason);
    }
    if (desc.debug)
        enableDebugOutput(*context);
    return context;
}

} // namespace lamina::headless
