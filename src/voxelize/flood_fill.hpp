#pragma once

#include "voxelize/solid_parts.hpp"

namespace lamina {

/// SolidRule::FloodFill: turns the voxels of a surface into all that the outside does not reach.
class FloodFill {
public:
    explicit FloodFill(std::shared_ptr<gl::DeviceState> device)
        : mDevice(device)
        , mParts(std::move(device)) {}

    /// Errors: ShaderError.
    [[nodiscard]] Result<void> initialize();

    /// Makes room for a grid of these parts. Errors: DeviceLimit, OutOfMemory.
    [[nodiscard]] Result<void> reserve(const GridTransform& transform,
                                       std::span<const GridPart> parts);
    /// Fills `words`, which hold the surface.
    void run(std::span<const GridPart> parts, const GridTransform& transform, GLuint words);

    /// Waits for the GPU. Errors: InvalidArgument before the first run().
    [[nodiscard]] Result<SolidReport> download() const { return mParts.download(); }

private:
    void bind(std::size_t part, GLuint words) const;
    void dispatchWords(GLuint program, GLuint words) const;
    void sweepColumns(GLuint words, bool up) const;
    void sweepRows(GLuint words, int axis) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    SolidParts mParts;
    gl::Buffer mOutside;
    gl::Buffer mCarry; ///< A word a column.
    GLuint mSeedProgram = 0;
    GLuint mColumnsProgram = 0;
    GLuint mRowsProgram = 0;
    GLuint mRoundProgram = 0;
    GLuint mEndProgram = 0;
};

} // namespace lamina
