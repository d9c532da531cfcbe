#pragma once

#include "gl/state_guard.hpp"

#include <array>
#include <vector>

namespace lamina::gl {

/// Saves texture units [first, first + count): every texture target that Lamina binds, and the
/// sampler object. Puts them back when it goes out of scope.
class TextureUnitGuard {
public:
    LAMINA_API TextureUnitGuard(DeviceState& device, GLuint first, GLuint count);
    LAMINA_API ~TextureUnitGuard();
    TextureUnitGuard(const TextureUnitGuard&) = delete;
    TextureUnitGuard& operator=(const TextureUnitGuard&) = delete;

private:
    static constexpr std::size_t kTargetCount = 11;
    struct Unit {
        std::array<GLint, kTargetCount> textures{};
        GLint sampler = 0;
    };

    DeviceState& mDevice;
    GLuint mFirst;
    std::vector<Unit> mUnits;
};

/// Saves image units [0, count) and puts them back when it goes out of scope.
class ImageUnitGuard {
public:
    LAMINA_API ImageUnitGuard(DeviceState& device, GLuint count);
    LAMINA_API ~ImageUnitGuard();
    ImageUnitGuard(const ImageUnitGuard&) = delete;
    ImageUnitGuard& operator=(const ImageUnitGuard&) = delete;

private:
    struct Unit {
        GLint name = 0, level = 0, layer = 0, access = 0, format = 0;
        GLboolean isLayered = GL_FALSE;
    };

    DeviceState& mDevice;
    std::vector<Unit> mUnits;
};

/// Saves shader storage buffer bindings [0, count) and the indirect draw buffer, for raster passes
/// whose shaders write buffers or whose draws come from one. Puts them back when it goes out of
/// scope.
class DrawBufferGuard {
public:
    LAMINA_API DrawBufferGuard(DeviceState& device, GLuint storageBuffers);
    LAMINA_API ~DrawBufferGuard();
    DrawBufferGuard(const DrawBufferGuard&) = delete;
    DrawBufferGuard& operator=(const DrawBufferGuard&) = delete;

private:
    DeviceState& mDevice;
    IndexedBufferBindings mStorageBuffers;
    GLint mIndirect = 0;
};

} // namespace lamina::gl
