#pragma once

#include "gl/device_state.hpp"
#include "voxelize/overlap_grid.hpp"

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

/// Turns crossings that the parity programs toggled into the inside of the mesh.
class SolidFill {
public:
    explicit SolidFill(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device)) {}

    /// Errors: ShaderError.
    [[nodiscard]] Result<void> initialize();

    /// Makes room for a grid of that many columns. Errors: OutOfMemory.
    [[nodiscard]] Result<void> reserve(std::uint64_t columns);
    /// Clears what it knows of columns and binds it (LAMINA_OVERLAP_COLUMNS_BINDING).
    void begin();
    /// Fills a part, whose constants and words are bound, and whose crossings are complete.
    void fill(const GridPart& part);

    /// Waits for the GPU. Errors: InvalidArgument before the first begin().
    [[nodiscard]] Result<SolidReport> download() const;

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Buffer mColumns;
    GLuint mProgram = 0;
    bool mHasReport = false;
};

} // namespace lamina
