#pragma once

#include "voxelize/overlap_passes.hpp"
#include "voxelize/solid_lines.hpp"
#include "voxelize/solid_parts.hpp"

#include <optional>
#include <vector>

namespace lamina {

/// SolidRule::Voted: counts the signed crossings of rays along solidLines(), one direction after
/// the other in the same cells, and adds up their votes: first those of the axes on all voxels,
/// then those of the diagonals on the contested ones, which takes next to nothing if there are
/// none.
class SolidVote {
public:
    explicit SolidVote(std::shared_ptr<gl::DeviceState> device)
        : mDevice(device)
        , mParts(device)
        , mConstants(gl::Buffer::create(std::move(device), "lamina solid lines")) {}

    /// Errors: ShaderError.
    [[nodiscard]] Result<void> initialize();

    /// Makes room for a grid of that shape. Errors: DeviceLimit, OutOfMemory.
    [[nodiscard]] Result<void> reserve(const GridTransform& transform,
                                       std::span<const GridPart> parts);
    /// Makes the solid of `sources` in `words`, which are clear. Returns the number of passes over
    /// the geometry.
    std::uint32_t run(OverlapPasses& passes, std::span<const OverlapSource> sources,
                      std::span<const GridPart> parts, const GridTransform& transform,
                      GLuint words);

    /// Waits for the GPU. Errors: InvalidArgument before the first run().
    [[nodiscard]] Result<SolidReport> download() const { return mParts.download(); }
    /// The voxels whose votes were close. Waits for the GPU.
    /// Errors: InvalidArgument before the first run(), OutOfMemory.
    [[nodiscard]] Result<BitGrid> downloadDoubtful() const;

private:
    /// The indirect dispatches of a call: for each part its tiles, for each batch of a diagonal its
    /// scan, for each chunk of triangles.
    [[nodiscard]] std::vector<shared::uvec4> dispatches(const OverlapPasses& passes,
                                                        std::size_t parts) const;
    void uploadConstants();
    void clearPlanes();
    void beginLine(OverlapPasses& passes, std::span<const OverlapSource> sources, std::size_t line,
                   const GridTransform& transform);
    void bindBatch(std::size_t constantsIndex, const SolidCells& cells, std::uint32_t batch);
    void voteAxes(OverlapPasses& passes, std::span<const OverlapSource> sources,
                  const GridTransform& transform, GLuint words);
    void settle(GLuint words, std::size_t dispatches);
    void voteDiagonals(OverlapPasses& passes, std::span<const OverlapSource> sources,
                       const GridTransform& transform, GLuint words);
    /// Binds planes and words of a part.
    void bindPart(std::size_t part, GLuint words);
    /// Runs a program over the texels of all parts, or over the listed tiles.
    void dispatchTexels(GLuint program, GLuint words);
    void dispatchTiles(GLuint program, GLuint words);

    std::shared_ptr<gl::DeviceState> mDevice;
    SolidParts mParts;
    gl::Buffer mConstants;
    gl::Buffer mCells;
    gl::Buffer mPlanes; ///< Three of votes, one of contested or doubtful voxels.
    gl::Buffer mTiles;
    OverlapPrograms mCrossings;
    GLuint mScanProgram = 0;
    GLuint mScanColumnsProgram = 0;
    GLuint mAxesProgram = 0;
    GLuint mDiagonalsProgram = 0;
    GLuint mSettleProgram = 0;
    GLuint mGateProgram = 0;
    GLuint mDoubtProgram = 0;
    std::vector<SolidCells> mLines;   ///< By number in solidLines().
    std::vector<OverlapSource> mSeen; ///< Sources as the lines of a direction see them.
    std::size_t mConstantStride = 0;
    std::uint64_t mGridBytes = 0;
    std::uint64_t mPlaneBytes = 0;           ///< From one plane to the next.
    std::size_t mBatch = 0;                  ///< Number of the next batch of the call.
    std::optional<GridTransform> mTransform; ///< Of the last run.
};

} // namespace lamina
