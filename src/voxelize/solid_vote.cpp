#include "voxelize/solid_vote.hpp"

#include "gl/dispatch.hpp"
#include "gl/program_cache.hpp"

#include <cstring>
#include <string>

namespace lamina {
namespace {

/// Planes of the votes beside the grid itself, which is the highest.
constexpr std::uint64_t kVotePlanes = 3;
/// In solidLines(): the lines along z.
constexpr std::size_t kAlongZ = 2;

std::uint64_t gridBytes(const glm::uvec3& size) {
    const std::uint64_t layers = (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
    return layers * size.x * size.y * 16;
}

shared::uvec4 linearDispatch(std::uint64_t invocations) {
    const auto groups = gl::linearGroups(invocations, LAMINA_OVERLAP_GROUP_SIZE);
    return {groups[0], groups[1], groups[2], 0};
}

/// Makes `buffer` at least so large; `isZero` if it need not.
Result<void> grow(const std::shared_ptr<gl::DeviceState>& device, gl::Buffer& buffer,
                  std::uint64_t bytes, std::string_view label, bool& isZero) {
    if (buffer.bytes() >= bytes)
        return {};
    isZero = false;
    auto larger = gl::createBuffer(device, bytes, nullptr, 0, "voxelize: solid by vote", label);
    if (!larger)
        return larger.error();
    buffer = std::move(*larger);
    return {};
}

} // namespace

Result<void> SolidVote::initialize() {
    const auto build = [this](GLuint& program, const char* shader,
                              std::vector<gl::ShaderDefine> defines = {}) -> Result<void> {
        auto built = gl::findOrBuildProgram(
            *mDevice, {"lamina solid vote", {{GL_COMPUTE_SHADER, shader}}, std::move(defines)});
        if (!built)
            return built.error();
        program = *built;
        return {};
    };
    const auto crossings = [](const char* how) {
        return gl::ShaderDefine{"LAMINA_CROSSINGS", how};
    };
    const gl::ShaderDefine isSigned = crossings("LAMINA_CROSSINGS_SIGNED");
    const gl::ShaderDefine isChecked = crossings("LAMINA_CROSSINGS_CHECKED");
    for (const auto& built :
         {build(mChecked.smallTriangles, "voxelize/crossings.comp", {isChecked}),
          build(mChecked.largeTriangles, "voxelize/crossings_large.comp", {isChecked}),
          build(mFillProgram, "voxelize/solid_fill.comp", {isChecked}),
          build(mVerdictProgram, "voxelize/solid_verdict.comp"),
          build(mGateProgram, "voxelize/solid_gate.comp"),
          build(mCrossings.smallTriangles, "voxelize/crossings.comp", {isSigned}),
          build(mCrossings.largeTriangles, "voxelize/crossings_large.comp", {isSigned}),
          build(mScanRowsProgram, "voxelize/solid_scan_rows.comp"),
          build(mScanColumnsProgram, "voxelize/solid_scan_columns.comp"),
          build(mSettleProgram, "voxelize/solid_settle.comp"),
          build(mScanProgram, "voxelize/solid_scan.comp"),
          build(mVoteProgram, "voxelize/solid_vote.comp"),

          build(mWipeProgram, "voxelize/solid_wipe.comp"),
          build(mDoubtProgram, "voxelize/solid_doubt.comp")})
        if (!built)
            return built;
    return {};
}

Result<void> SolidVote::reserve(const GridTransform& transform, std::span<const GridPart> parts) {
    if (auto fits = checkSolidSize(transform.size(), SolidRule::Voted); !fits)
        return fits;
    std::vector<SolidCells> lines;
    std::uint64_t cellBytes = 0;
    std::uint64_t touchedBytes = 0;
    for (const SolidLine& line : solidLines()) {
        auto cells = solidCells(*mDevice, line, transform.size());
        if (!cells)
            return cells.error();
        cellBytes = std::max(cellBytes, cells->rowBytes * cells->rowsPerBatch);
        touchedBytes = std::max(touchedBytes, cells->touchedBytes());
        lines.push_back(*cells);
    }
    const std::uint64_t alignment = mDevice->limits.storageBufferOffsetAlignment;
    const std::uint64_t bytes = gridBytes(transform.size());
    const std::uint64_t planeBytes = (bytes + alignment - 1) / alignment * alignment;
    std::uint64_t tiles = 0;
    for (const GridPart& part : parts)
        tiles += tileCount(part);
    mTransform.reset();
    bool isUsedWithoutClearing = true;
    for (const auto& grown :
         {grow(mDevice, mCells, cellBytes, "lamina solid cells", mIsZero),
          grow(mDevice, mTouched, touchedBytes, "lamina solid touched cells", mIsZero),
          grow(mDevice, mPlanes, planeBytes * kVotePlanes, "lamina solid votes", mIsZero),
          grow(mDevice, mContested, planeBytes, "lamina solid contested", isUsedWithoutClearing),
          grow(mDevice, mTiles, tiles * sizeof(GLuint), "lamina solid tiles",
               isUsedWithoutClearing)})
        if (!grown)
            return grown;
    mLines = std::move(lines);
    mGridBytes = bytes;
    mPlaneBytes = planeBytes;
    return {};
}

void SolidVote::uploadConstants() {
    const std::size_t alignment = mDevice->limits.uniformBufferOffsetAlignment;
    mConstantStride = (sizeof(shared::LaminaSolidLine) + alignment - 1) / alignment * alignment;
    std::vector<std::byte> bytes;
    mFirstBatch.clear();
    std::size_t batches = 0;
    for (const SolidCells& cells : mLines) {
        mFirstBatch.push_back(batches);
        batches += cells.batches();
        for (std::uint32_t batch = 0; batch < cells.batches(); ++batch) {
            const shared::LaminaSolidLine block = cells.batch(batch);
            bytes.resize(bytes.size() + mConstantStride);
            std::memcpy(bytes.data() + bytes.size() - mConstantStride, &block, sizeof block);
        }
    }
    // New storage each time: dispatches of the last call may still read the old.
    mDevice->gl.NamedBufferData(mConstants.id(), static_cast<GLsizeiptr>(bytes.size()),
                                bytes.data(), GL_STREAM_DRAW);
}

void SolidVote::clearOnce() {
    if (mIsZero)
        return;
    for (const gl::Buffer* buffer : {&mCells, &mTouched, &mPlanes})
        mDevice->gl.ClearNamedBufferData(buffer->id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT,
                                         nullptr);
    mIsZero = true;
}

SolidVote::Dispatches SolidVote::dispatches(const OverlapPasses& passes,
                                            std::span<const GridPart> parts) const {
    Dispatches all;
    all.list.assign(parts.size(), shared::uvec4(0, 0, 1, 0)); // listed tiles
    const auto addChunks = [&] {
        for (const GLuint groups : passes.smallGroups())
            all.list.emplace_back(groups, 1, 1, 0);
    };
    const auto addScans = [&](std::size_t line) {
        for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch)
            all.list.push_back(linearDispatch(mLines[line].scans(batch)));
    };
    all.alongZ = all.list.size();
    addChunks();
    addScans(kAlongZ);
    all.alongXY = all.list.size();
    addChunks();
    for (std::size_t line = 0; line < kAlongZ; ++line)
        addScans(line);
    all.settle = all.list.size();
    for (const GridPart& part : parts)
        all.list.push_back(texelGroups(part));
    all.diagonals = all.list.size();
    addChunks();
    for (std::size_t line = LAMINA_SOLID_AXIS_COUNT; line < mLines.size(); ++line)
        addScans(line);
    return all;
}

void SolidVote::bindBatch(std::size_t line, std::uint32_t batch) {
    const GladGLContext& gl = mDevice->gl;
    const GLuint constants = mConstants.id();
    const auto offset = static_cast<GLintptr>((mFirstBatch[line] + batch) * mConstantStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaSolidLine);
    gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_SOLID_LINE_BINDING, 1, &constants, &offset,
                        &kBytes);
    const GLuint cells = mCells.id();
    const GLuint touched = mTouched.id();
    constexpr GLintptr kBegin = 0;
    const auto bytes = static_cast<GLsizeiptr>(mLines[line].bytes(batch));
    gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_CELLS_BINDING, 1, &cells, &kBegin,
                        &bytes);
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_TOUCHED_BINDING, 1, &touched);
}

void SolidVote::bindPart(std::size_t part, GLuint words) const {
    mParts.bind(part, words);
    for (GLuint plane = 0; plane < kVotePlanes; ++plane)
        mParts.bindRange(part, LAMINA_SOLID_VOTES_BINDING + plane, mPlanes.id(),
                         plane * mPlaneBytes);
}

void SolidVote::dispatch(std::size_t number) const {
    mDevice->gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, mParts.tally());
    mDevice->gl.DispatchComputeIndirect(SolidParts::dispatchOffset(number));
}

void SolidVote::dispatchParts(GLuint program, GLuint words, std::size_t first) const {
    mDevice->gl.UseProgram(program);
    for (std::size_t part = 0; part < mParts.count(); ++part) {
        bindPart(part, words);
        mParts.bindRange(part, LAMINA_SOLID_CONTESTED_BINDING, mContested.id(), 0);
        dispatch(first + part);
    }
    mDevice->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::gate(std::size_t first, std::size_t end, int tallyWord, bool isNeededIfSet) const {
    const GladGLContext& gl = mDevice->gl;
    const auto count = static_cast<GLint>(end - first);
    gl.UseProgram(mGateProgram);
    gl.ProgramUniform1i(mGateProgram, 0, static_cast<GLint>(first));
    gl.ProgramUniform1i(mGateProgram, 1, count);
    gl.ProgramUniform1i(mGateProgram, 2, tallyWord);
    gl.ProgramUniform1i(mGateProgram, 3, isNeededIfSet ? 1 : 0);
    gl::dispatchLinear(gl, static_cast<std::uint64_t>(count), LAMINA_OVERLAP_GROUP_SIZE);
    gl.MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::fill(OverlapPasses& passes, std::span<const GridPart> parts, GLuint words) {
    const GladGLContext& gl = mDevice->gl;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        mParts.bind(part, words);
        passes.run(mChecked, part);
        gl.UseProgram(mFillProgram);
        gl::dispatchLinear(gl, parts[part].columns(), LAMINA_OVERLAP_GROUP_SIZE);
    }
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    gl.UseProgram(mVerdictProgram);
    gl.DispatchCompute(1, 1, 1);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::beginLine(OverlapPasses& passes, std::span<const OverlapSource> sources,
                          std::size_t line, const GridTransform& transform) {
    mSeen.assign(sources.begin(), sources.end());
    for (OverlapSource& source : mSeen)
        source.localToGrid = gridToLines(solidLines()[line]) * source.localToGrid;
    mLineParts.clear();
    mFirstLinePart.clear();
    for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch) {
        mFirstLinePart.push_back(mLineParts.size());
        const std::vector<GridPart> parts =
            linesParts(solidLines()[line], transform.size(), mLines[line].batch(batch));
        mLineParts.insert(mLineParts.end(), parts.begin(), parts.end());
    }
    mFirstLinePart.push_back(mLineParts.size());
    passes.begin(mSeen, mLineParts, transform);
}

void SolidVote::countCrossings(OverlapPasses& passes, std::uint32_t batch, std::size_t chunks) {
    const DispatchGate gate{mParts.tally(), SolidParts::dispatchOffset(chunks),
                            SolidParts::dispatchOffset(1) - SolidParts::dispatchOffset(0)};
    for (std::size_t part = mFirstLinePart[batch]; part < mFirstLinePart[batch + 1]; ++part) {
        passes.run(mCrossings, part, gate);
        ++mPasses;
    }
}

void SolidVote::voteAxis(OverlapPasses& passes, std::span<const OverlapSource> sources,
                         std::size_t line, const GridTransform& transform, GLuint words,
                         std::size_t chunks, std::size_t scans) {
    const GladGLContext& gl = mDevice->gl;
    beginLine(passes, sources, line, transform);
    const GLuint program = mLines[line].isAlongWords() ? mScanColumnsProgram : mScanRowsProgram;
    for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch) {
        bindBatch(line, batch);
        countCrossings(passes, batch, chunks);
        gl.UseProgram(program);
        for (std::size_t part = 0; part < mParts.count(); ++part) {
            gl.ProgramUniform1i(program, 0, part + 1 == mParts.count() ? 1 : 0);
            bindPart(part, words);
            dispatch(scans + batch);
            // The last part leaves cells zero that the others read.
            gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        }
    }
}

void SolidVote::voteDiagonals(OverlapPasses& passes, std::span<const OverlapSource> sources,
                              const GridTransform& transform, GLuint words, std::size_t chunks) {
    const GladGLContext& gl = mDevice->gl;
    std::size_t scan = chunks + passes.smallGroups().size();
    for (std::size_t line = LAMINA_SOLID_AXIS_COUNT; line < mLines.size(); ++line) {
        beginLine(passes, sources, line, transform);
        for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch) {
            bindBatch(line, batch);
            countCrossings(passes, batch, chunks);
            gl.UseProgram(mScanProgram);
            dispatch(scan);
            gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            dispatchParts(mVoteProgram, words, 0);
            gl.UseProgram(mWipeProgram);
            dispatch(scan++);
            gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        }
    }
    dispatchParts(mDoubtProgram, words, 0);
}

std::uint32_t SolidVote::run(OverlapPasses& passes, std::span<const OverlapSource> sources,
                             std::span<const GridPart> parts, const GridTransform& transform,
                             GLuint words) {
    mTransform = transform;
    mPasses = static_cast<std::uint32_t>(parts.size());
    clearOnce();
    uploadConstants();
    passes.begin(sources, parts, transform);
    const Dispatches all = dispatches(passes, parts);
    mParts.begin(parts, transform, all.list);
    if (!passes.hasTriangles())
        return 0;
    const GLuint tiles = mTiles.id();
    mDevice->gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_TILES_BINDING, 1, &tiles);
    fill(passes, parts, words);
    gate(all.alongZ, all.list.size(), LAMINA_TALLY_CLEAN, false);
    const std::size_t chunks = passes.smallGroups().size();
    voteAxis(passes, sources, kAlongZ, transform, words, all.alongZ, all.alongZ + chunks);
    gate(all.alongXY, all.settle, LAMINA_TALLY_CLOSED, false);
    std::size_t scans = all.alongXY + chunks;
    for (std::size_t line = 0; line < kAlongZ; ++line) {
        voteAxis(passes, sources, line, transform, words, all.alongXY, scans);
        scans += mLines[line].batches();
    }
    dispatchParts(mSettleProgram, words, all.settle);
    gate(all.diagonals, all.list.size(), LAMINA_TALLY_CONTESTED, true);
    voteDiagonals(passes, sources, transform, words, all.diagonals);
    return mPasses;
}

Result<BitGrid> SolidVote::downloadDoubtful() const {
    if (!mTransform)
        return Error{ErrorCode::InvalidArgument,
                     "doubtful voxels: expected voxels, found none; voxelize first"};
    auto bits = BitGrid::create(*mTransform);
    // Where there is no contested voxel, nothing has been written.
    if (!bits || !mParts.downloadIsContested())
        return bits;
    mDevice->gl.GetNamedBufferSubData(mContested.id(), 0, static_cast<GLsizeiptr>(mGridBytes),
                                      bits->words().data());
    return bits;
}

} // namespace lamina
