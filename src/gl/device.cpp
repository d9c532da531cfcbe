#include "gl/device_state.hpp"

#include <lamina/gl/device.hpp>

#include <algorithm>
#include <array>
#include <cctype>

namespace lamina {
namespace gl {
namespace {

std::string text(const GladGLContext& gl, GLenum name) {
    const GLubyte* value = gl.GetString(name);
    return value ? reinterpret_cast<const char*>(value) : "";
}

std::uint32_t limit(const GladGLContext& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return static_cast<std::uint32_t>(std::max(value, 0));
}

DeviceLimits readLimits(const GladGLContext& gl) {
    DeviceLimits limits;
    limits.maxTextureSize = limit(gl, GL_MAX_TEXTURE_SIZE);
    limits.maxArrayTextureLayers = limit(gl, GL_MAX_ARRAY_TEXTURE_LAYERS);
    std::array<GLint, 2> viewport{};
    gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
    limits.maxViewportWidth = static_cast<std::uint32_t>(viewport[0]);
    limits.maxViewportHeight = static_cast<std::uint32_t>(viewport[1]);
    limits.maxDrawBuffers = limit(gl, GL_MAX_DRAW_BUFFERS);
    limits.maxVertexAttribStride = limit(gl, GL_MAX_VERTEX_ATTRIB_STRIDE);
    limits.maxUniformBufferBindings = limit(gl, GL_MAX_UNIFORM_BUFFER_BINDINGS);
    limits.maxCombinedTextureUnits = limit(gl, GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS);
    limits.uniformBufferOffsetAlignment =
        std::max(limit(gl, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT), 1u);
    limits.maxTextureBufferTexels = limit(gl, GL_MAX_TEXTURE_BUFFER_SIZE);
    // Some drivers do not enforce it: a binding may be larger, and shaders then lose what is
    // beyond.
    GLint64 storageBlock = 0;
    gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &storageBlock);
    limits.maxStorageBlockBytes = static_cast<std::uint64_t>(std::max<GLint64>(storageBlock, 0));
    limits.storageBufferOffsetAlignment =
        std::max(limit(gl, GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT), 1u);
    limits.subpixelBits = limit(gl, GL_SUBPIXEL_BITS);
    return limits;
}

bool rasterizesOnCpu(std::string renderer) {
    std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::array kSoftware = {"llvmpipe", "softpipe", "swrast", "swiftshader",
                                      "software rasterizer"};
    return std::any_of(kSoftware.begin(), kSoftware.end(),
                       [&](const char* name) { return renderer.find(name) != std::string::npos; });
}

GLADapiproc loadThrough(void* user, const char* name) {
    return reinterpret_cast<GLADapiproc>((*static_cast<const GetProcAddress*>(user))(name));
}

} // namespace

Result<void> checkContext(const DeviceState& device, std::string_view operation) {
    if (device.gl.GetString(GL_VERSION) != nullptr)
        return {};
    return Error{ErrorCode::NoContext, std::string(operation) +
                                           ": expected the device's GL context current on this "
                                           "thread, found none; make it current first"};
}

Result<void> checkSameDevice(const DeviceState& device, const DeviceState* other,
                             std::string_view operation, std::string_view what) {
    if (other == &device)
        return {};
    return Error{ErrorCode::InvalidArgument,
                 std::string(operation) + ": expected " + std::string(what) +
                     " of the same device, found that of another; create it from the device that "
                     "this was created from"};
}

DebugGroup::DebugGroup(DeviceState& device, std::string_view name)
    : mDevice(device) {
    // A host that has filled the group stack must not get an overflow error from us.
    GLint depth = 0;
    GLint maxDepth = 0;
    device.gl.GetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
    device.gl.GetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &maxDepth);
    mPushed = depth < maxDepth;
    if (mPushed)
        device.gl.PushDebugGroup(GL_DEBUG_SOURCE_THIRD_PARTY, 0, static_cast<GLsizei>(name.size()),
                                 name.data());
}

DebugGroup::~DebugGroup() {
    if (mPushed)
        mDevice.gl.PopDebugGroup();
}

} // namespace gl

Result<Device> Device::fromCurrentContext(const GetProcAddress& load, const DeviceDesc& desc) {
    auto state = std::make_shared<gl::DeviceState>();
    GetProcAddress loader = load;
    // glad asks glGetString for the version first: without a context that yields nothing.
    if (laminaGladLoadContextUserPtr(&state->gl, gl::loadThrough, &loader) == 0)
        return Error{
            ErrorCode::NoContext,
            "device: expected a GL context current on this thread, found none (or the loader "
            "knows no GL functions); make the context current first"};
    DeviceInfo& info = state->info;
    info.vendor = gl::text(state->gl, GL_VENDOR);
    info.renderer = gl::text(state->gl, GL_RENDERER);
    info.version = gl::text(state->gl, GL_VERSION);
    state->gl.GetIntegerv(GL_MAJOR_VERSION, &info.majorVersion);
    state->gl.GetIntegerv(GL_MINOR_VERSION, &info.minorVersion);
    const bool isEs = info.version.starts_with("OpenGL ES");
    if (isEs || !state->gl.VERSION_4_5)
        return Error{ErrorCode::UnsupportedDevice,
                     "device: expected OpenGL 4.5 or newer, found " + info.version + " (" +
                         info.renderer + "); ask for a 4.5 core context or update the driver"};
    info.isSoftware = gl::rasterizesOnCpu(info.renderer);
    state->limits = gl::readLimits(state->gl);
    state->desc = desc;
    return Device(std::move(state));
}

Device::Device(std::shared_ptr<gl::DeviceState> state)
    : mState(std::move(state)) {}
Device::Device(Device&&) noexcept = default;

Device& Device::operator=(Device&& other) noexcept {
    std::swap(mState, other.mState);
    return *this;
}

Device::~Device() {
    if (!mState)
        return;
    for (const auto& [key, program] : mState->programs)
        mState->gl.DeleteProgram(program);
    mState->programs.clear();
}

const DeviceInfo& Device::info() const {
    return mState->info;
}
const DeviceLimits& Device::limits() const {
    return mState->limits;
}
std::uint64_t Device::allocatedBytes() const {
    return mState->allocatedBytes;
}
void Device::setMemoryBudget(std::uint64_t bytes) {
    mState->desc.memoryBudgetBytes = bytes;
}

} // namespace lamina
