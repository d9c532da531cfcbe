#pragma once

#include "gl/device_state.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <vector>

namespace lamina {

/// A bit for each column of a raster backend's solid: odd number of crossings. An image of 32
/// columns a texel, whose bits the fragment stage toggles.
class ColumnParity {
public:
    explicit ColumnParity(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device)) {}

    /// Makes room for the columns of a grid of this size. Errors: DeviceLimit, OutOfMemory.
    [[nodiscard]] Result<void> reserve(const glm::uvec3& size);
    /// Clears the bits and binds them to image unit LAMINA_COLUMN_PARITY_IMAGE.
    void begin();
    /// After the last draw.
    void end();
    /// Waits for the GPU. Errors: InvalidArgument before the first end().
    [[nodiscard]] Result<SolidReport> download() const;

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Texture mBits;
    glm::uvec2 mSize{0}; ///< Texels.
    bool mHasReport = false;
};

} // namespace lamina
