#pragma once

#include "voxelize/overlap_passes.hpp"
#include "voxelize/solid_lines.hpp"
#include "voxelize/solid_parts.hpp"

#include <optional>
#include <vector>

namespace lamina {

/// SolidRule::Voted. First fills by parity along z, in sums that tell whether that is all
/// (crossing_check.glsl). If not, counts the signed crossings of rays along solidLines(), one
/// direction after the other in the same cells, and adds up their votes: along z; if the mesh is
/// not closed, along the other axes; then those of the diagonals on the contested voxels. What is
/// not needed is dispatched in vain: next to nothing.
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
    /// Indirect dispatches that the tally's buffer holds: for each part its listed tiles, then
    struct Dispatches {
        std::vector<shared::uvec4> list;
        std::size_t alongZ = 0;    ///< Chunks of triangles, scans of the batches.
        std::size_t alongXY = 0;   ///< Chunks, scans of x, scans of y.
        std::size_t settle = 0;    ///< Parts.
        std::size_t diagonals = 0; ///< Chunks, scans.
    };
    [[nodiscard]] Dispatches dispatches(const OverlapPasses& passes,
                                        std::span<const GridPart> parts) const;
    void uploadConstants();
    /// Makes cells, touched bits and votes zero, as each call leaves them.
    void clearOnce();
    void bindBatch(std::size_t line, std::uint32_t batch);
    /// Binds votes and words of a part.
    void bindPart(std::size_t part, GLuint words) const;
    void dispatch(std::size_t number) const;
    /// The dispatches from `first` on, one for each part; those over the listed tiles are at 0.
    void dispatchParts(GLuint program, GLuint words, std::size_t first) const;
    /// Empties the dispatches [first, end) that a word of the tally says are not needed.
    void gate(std::size_t first, std::size_t end, int tallyWord, bool isNeededIfSet) const;
    /// Parity, and the verdict whether it is the solid.
    void fill(OverlapPasses& passes, std::span<const GridPart> parts, GLuint words);
    void beginLine(OverlapPasses& passes, std::span<const OverlapSource> sources, std::size_t line,
                   const GridTransform& transform);
    /// Of a batch of the line that has begun. chunks: number of the first dispatch.
    void countCrossings(OverlapPasses& passes, std::uint32_t batch, std::size_t chunks);
    void voteAxis(OverlapPasses& passes, std::span<const OverlapSource> sources, std::size_t line,
                  const GridTransform& transform, GLuint words, std::size_t chunks,
                  std::size_t scans);
    void voteDiagonals(OverlapPasses& passes, std::span<const OverlapSource> sources,
                       const GridTransform& transform, GLuint words, std::size_t chunks);

    std::shared_ptr<gl::DeviceState> mDevice;
    SolidParts mParts;
    gl::Buffer mConstants;
    gl::Buffer mCells;
    gl::Buffer mTouched;   ///< Which cells of an axis are not zero.
    gl::Buffer mPlanes;    ///< Three, of votes.
    gl::Buffer mContested; ///< Then doubtful voxels.
    gl::Buffer mTiles;
    OverlapPrograms mChecked;
    OverlapPrograms mCrossings;
    GLuint mFillProgram = 0;
    GLuint mVerdictProgram = 0;
    GLuint mGateProgram = 0;
    GLuint mScanRowsProgram = 0;
    GLuint mScanColumnsProgram = 0;
    GLuint mSettleProgram = 0;
    GLuint mScanProgram = 0;
    GLuint mVoteProgram = 0;
    GLuint mWipeProgram = 0;
    GLuint mDoubtProgram = 0;
    std::vector<SolidCells> mLines;          ///< By number in solidLines().
    std::vector<std::size_t> mFirstBatch;    ///< Of each line among the constants.
    std::vector<OverlapSource> mSeen;        ///< Sources as the lines of a direction see them.
    std::vector<GridPart> mLineParts;        ///< Of the direction's batches, one after the other.
    std::vector<std::size_t> mFirstLinePart; ///< Of each batch; then their number.
    std::size_t mConstantStride = 0;
    std::uint64_t mGridBytes = 0;
    std::uint64_t mPlaneBytes = 0;           ///< From one plane to the next.
    std::uint32_t mPasses = 0;               ///< Over the geometry, of the call.
    bool mIsZero = false;                    ///< Cells, touched bits and votes.
    std::optional<GridTransform> mTransform; ///< Of the last run.
};

} // namespace lamina
