#pragma once

#include "gl/device_state.hpp"
#include "voxelize/overlap_grid.hpp"
#include "voxelize/solid_constants.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <cstdint>
#include <span>

namespace lamina {

/// Errors: DeviceLimit if a side of the grid is too long for the programs of `rule`.
[[nodiscard]] Result<void> checkSolidSize(const glm::uvec3& size, SolidRule rule);

/// Runs of 64 texels along x: work groups over a part.
[[nodiscard]] std::uint64_t tileCount(const GridPart& part);

/// Work groups of a program that runs over all texels of a part (solid_part.glsl), as an indirect
/// dispatch.
[[nodiscard]] shared::uvec4 texelGroups(const GridPart& part);

/// The parts of a grid as the programs of the solid rules see them, and the tally they report to.
class SolidParts {
public:
    explicit SolidParts(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device))
        , mConstants(gl::Buffer::create(mDevice, "lamina solid parts"))
        , mTally(gl::Buffer::create(mDevice, "lamina solid tally")) {}

    /// Tells the device about the parts and clears the tally. `parts` are borrowed.
    /// dispatches: indirect ones that the tally's buffer holds. GL: binds the tally, also as
    /// indirect buffer.
    void begin(std::span<const GridPart> parts, const GridTransform& transform,
               std::span<const shared::uvec4> dispatches);

    [[nodiscard]] std::size_t count() const { return mParts.size(); }
    /// Runs the bound program over a part: an invocation for each texel (solid_part.glsl).
    void dispatchTexels(std::size_t part) const;
    /// Binds a part's constants, and its range of the grid's words.
    void bind(std::size_t part, GLuint words) const;
    /// Binds the same range of another buffer of that shape, which begins at `offsetBytes`.
    void bindRange(std::size_t part, GLuint binding, GLuint buffer,
                   std::uint64_t offsetBytes) const;
    /// The tally's buffer, and where in it an indirect dispatch is.
    [[nodiscard]] GLuint tally() const { return mTally.id(); }
    [[nodiscard]] static GLintptr dispatchOffset(std::size_t dispatch) {
        return static_cast<GLintptr>((LAMINA_TALLY_DISPATCHES + dispatch * 4) * sizeof(GLuint));
    }

    /// What the programs reported; whether a flood ended in the midst. Waits for the GPU.
    /// Errors: InvalidArgument before the first begin().
    [[nodiscard]] Result<SolidReport> download() const;
    /// After the first begin(). Waits for the GPU.
    [[nodiscard]] bool downloadIsContested() const;

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    gl::Buffer mConstants;
    gl::Buffer mTally;
    std::span<const GridPart> mParts;
    std::size_t mConstantStride = 0;
    bool mHasReport = false;
};

} // namespace lamina
