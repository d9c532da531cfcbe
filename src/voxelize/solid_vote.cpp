#include "voxelize/solid_vote.hpp"

#include "gl/dispatch.hpp"
#include "gl/program_cache.hpp"

#include <cstring>
#include <string>

namespace lamina {
namespace {

/// Planes of the votes beside the grid itself, which is the highest; behind them the contested.
constexpr std::uint64_t kVotePlanes = 3;
constexpr std::uint64_t kPlanes = kVotePlanes + 1;

std::uint64_t gridBytes(const glm::uvec3& size) {
    const std::uint64_t layers = (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
    return layers * size.x * size.y * 16;
}

/// Makes `buffer` at least so large.
Result<void> grow(const std::shared_ptr<gl::DeviceState>& device, gl::Buffer& buffer,
                  std::uint64_t bytes, std::string_view label) {
    if (buffer.bytes() >= bytes)
        return {};
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
    const gl::ShaderDefine isSigned{"LAMINA_CROSSINGS", "LAMINA_CROSSINGS_SIGNED"};
    for (const auto& built :
         {build(mCrossings.smallTriangles, "voxelize/crossings.comp", {isSigned}),
          build(mCrossings.largeTriangles, "voxelize/crossings_large.comp", {isSigned}),
          build(mScanProgram, "voxelize/solid_scan.comp"),
          build(mScanColumnsProgram, "voxelize/solid_scan_columns.comp"),
          build(mAxesProgram, "voxelize/solid_vote.comp",
                {{"LAMINA_SOLID_VOTERS", "LAMINA_SOLID_VOTERS_AXES"}}),
          build(mDiagonalsProgram, "voxelize/solid_vote.comp",
                {{"LAMINA_SOLID_VOTERS", "LAMINA_SOLID_VOTERS_DIAGONALS"}}),
          build(mSettleProgram, "voxelize/solid_settle.comp"),
          build(mGateProgram, "voxelize/solid_gate.comp"),
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
    for (const SolidLine& line : solidLines()) {
        auto cells = solidCells(*mDevice, line, transform.size());
        if (!cells)
            return cells.error();
        cellBytes = std::max(cellBytes, cells->rowBytes * cells->rowsPerBatch);
        lines.push_back(*cells);
    }
    const std::uint64_t alignment = mDevice->limits.storageBufferOffsetAlignment;
    const std::uint64_t bytes = gridBytes(transform.size());
    const std::uint64_t planeBytes = (bytes + alignment - 1) / alignment * alignment;
    mTransform.reset();
    if (auto grown = grow(mDevice, mCells, cellBytes, "lamina solid cells"); !grown)
        return grown;
    if (auto grown = grow(mDevice, mPlanes, planeBytes * kPlanes, "lamina solid votes"); !grown)
        return grown;
    std::uint64_t tiles = 0;
    for (const GridPart& part : parts)
        tiles += tileCount(part);
    if (auto grown = grow(mDevice, mTiles, tiles * sizeof(GLuint), "lamina solid tiles"); !grown)
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
    for (const SolidCells& cells : mLines)
        for (std::uint32_t batch = 0; batch < cells.batches(); ++batch) {
            const shared::LaminaSolidLine block = cells.batch(batch);
            bytes.resize(bytes.size() + mConstantStride);
            std::memcpy(bytes.data() + bytes.size() - mConstantStride, &block, sizeof block);
        }
    // New storage each time: dispatches of the last call may still read the old.
    mDevice->gl.NamedBufferData(mConstants.id(), static_cast<GLsizeiptr>(bytes.size()),
                                bytes.data(), GL_STREAM_DRAW);
}

void SolidVote::bindBatch(std::size_t constantsIndex, const SolidCells& cells,
                          std::uint32_t batch) {
    const GladGLContext& gl = mDevice->gl;
    const GLuint constants = mConstants.id();
    const auto offset = static_cast<GLintptr>(constantsIndex * mConstantStride);
    constexpr GLsizeiptr kBytes = sizeof(shared::LaminaSolidLine);
    gl.BindBuffersRange(GL_UNIFORM_BUFFER, LAMINA_SOLID_LINE_BINDING, 1, &constants, &offset,
                        &kBytes);
    const GLuint buffer = mCells.id();
    constexpr GLintptr kBegin = 0;
    const auto bytes = static_cast<GLsizeiptr>(
        cells.rowBytes * static_cast<std::uint64_t>(cells.batch(batch).rows.y));
    gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_CELLS_BINDING, 1, &buffer, &kBegin,
                        &bytes);
    gl.ClearNamedBufferSubData(buffer, GL_R32UI, 0, bytes, GL_RED_INTEGER, GL_UNSIGNED_INT,
                               nullptr);
}

void SolidVote::clearPlanes() {
    mDevice->gl.ClearNamedBufferSubData(mPlanes.id(), GL_R32UI, 0,
                                        static_cast<GLsizeiptr>(mPlaneBytes * kPlanes),
                                        GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

std::vector<shared::uvec4> SolidVote::dispatches(const OverlapPasses& passes,
                                                 std::size_t parts) const {
    std::vector<shared::uvec4> list(parts, shared::uvec4(0, 0, 1, 0));
    for (std::size_t line = LAMINA_SOLID_AXIS_COUNT; line < mLines.size(); ++line)
        for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch) {
            const auto groups =
                gl::linearGroups(mLines[line].scans(batch), LAMINA_OVERLAP_GROUP_SIZE);
            list.emplace_back(groups[0], groups[1], groups[2], 0);
        }
    for (const GLuint groups : passes.smallGroups())
        list.emplace_back(groups, 1, 1, 0);
    return list;
}

void SolidVote::bindPart(std::size_t part, GLuint words) {
    mParts.bind(part, words);
    for (GLuint plane = 0; plane < kVotePlanes; ++plane)
        mParts.bindRange(part, LAMINA_SOLID_VOTES_BINDING + plane, mPlanes.id(),
                         plane * mPlaneBytes);
    mParts.bindRange(part, LAMINA_SOLID_CONTESTED_BINDING, mPlanes.id(), kVotePlanes * mPlaneBytes);
}

void SolidVote::dispatchTexels(GLuint program, GLuint words) {
    mDevice->gl.UseProgram(program);
    for (std::size_t part = 0; part < mParts.count(); ++part) {
        bindPart(part, words);
        mParts.dispatchTexels(part);
    }
    // The next direction clears the cells, and adds to the same votes.
    mDevice->gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::dispatchTiles(GLuint program, GLuint words) {
    const GladGLContext& gl = mDevice->gl;
    gl.UseProgram(program);
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, mParts.tally());
    for (std::size_t part = 0; part < mParts.count(); ++part) {
        bindPart(part, words);
        gl.DispatchComputeIndirect(SolidParts::dispatchOffset(part));
    }
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::beginLine(OverlapPasses& passes, std::span<const OverlapSource> sources,
                          std::size_t line, const GridTransform& transform) {
    mSeen.assign(sources.begin(), sources.end());
    for (OverlapSource& source : mSeen)
        source.localToGrid = gridToLines(solidLines()[line]) * source.localToGrid;
    const GridPart part = linesPart(solidLines()[line], transform.size());
    passes.begin(mSeen, {&part, 1}, transform);
}

void SolidVote::voteAxes(OverlapPasses& passes, std::span<const OverlapSource> sources,
                         const GridTransform& transform, GLuint words) {
    for (std::size_t line = 0; line < LAMINA_SOLID_AXIS_COUNT; ++line) {
        beginLine(passes, sources, line, transform);
        const SolidCells& cells = mLines[line];
        for (std::uint32_t batch = 0; batch < cells.batches(); ++batch) {
            bindBatch(mBatch++, cells, batch);
            passes.run(mCrossings, 0);
            mDevice->gl.UseProgram(cells.isAlongWords() ? mScanColumnsProgram : mScanProgram);
            gl::dispatchLinear(mDevice->gl, cells.scans(batch), LAMINA_OVERLAP_GROUP_SIZE);
            mDevice->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            dispatchTexels(mAxesProgram, words);
        }
    }
}

void SolidVote::settle(GLuint words, std::size_t dispatches) {
    const GladGLContext& gl = mDevice->gl;
    dispatchTexels(mSettleProgram, words);
    const std::size_t tiles = mParts.count();
    gl.UseProgram(mGateProgram);
    gl.ProgramUniform1i(mGateProgram, 0, static_cast<GLint>(tiles));
    gl.ProgramUniform1i(mGateProgram, 1, static_cast<GLint>(dispatches - tiles));
    gl::dispatchLinear(gl, dispatches - tiles, LAMINA_OVERLAP_GROUP_SIZE);
    gl.MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void SolidVote::voteDiagonals(OverlapPasses& passes, std::span<const OverlapSource> sources,
                              const GridTransform& transform, GLuint words) {
    std::size_t scan = mParts.count();
    DispatchGate gate{mParts.tally(), 0,
                      SolidParts::dispatchOffset(1) - SolidParts::dispatchOffset(0)};
    std::size_t chunks = scan;
    for (std::size_t line = LAMINA_SOLID_AXIS_COUNT; line < mLines.size(); ++line)
        chunks += mLines[line].batches();
    gate.offset = SolidParts::dispatchOffset(chunks);
    for (std::size_t line = LAMINA_SOLID_AXIS_COUNT; line < mLines.size(); ++line) {
        beginLine(passes, sources, line, transform);
        for (std::uint32_t batch = 0; batch < mLines[line].batches(); ++batch) {
            bindBatch(mBatch++, mLines[line], batch);
            passes.run(mCrossings, 0, gate);
            mDevice->gl.UseProgram(mScanProgram);
            mDevice->gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, mParts.tally());
            mDevice->gl.DispatchComputeIndirect(SolidParts::dispatchOffset(scan++));
            mDevice->gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            dispatchTiles(mDiagonalsProgram, words);
        }
    }
    dispatchTiles(mDoubtProgram, words);
}

std::uint32_t SolidVote::run(OverlapPasses& passes, std::span<const OverlapSource> sources,
                             std::span<const GridPart> parts, const GridTransform& transform,
                             GLuint words) {
    mTransform = transform;
    mBatch = 0;
    clearPlanes();
    uploadConstants();
    // The same chunks for every line.
    beginLine(passes, sources, 0, transform);
    const std::vector<shared::uvec4> list = dispatches(passes, parts.size());
    mParts.begin(parts, transform, list);
    if (!passes.hasTriangles())
        return 0;
    const GLuint tiles = mTiles.id();
    mDevice->gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_SOLID_TILES_BINDING, 1, &tiles);
    voteAxes(passes, sources, transform, words);
    settle(words, list.size());
    voteDiagonals(passes, sources, transform, words);
    return static_cast<std::uint32_t>(mBatch);
}

Result<BitGrid> SolidVote::downloadDoubtful() const {
    if (!mTransform)
        return Error{ErrorCode::InvalidArgument,
                     "doubtful voxels: expected voxels, found none; voxelize first"};
    auto bits = BitGrid::create(*mTransform);
    if (!bits)
        return bits;
    mDevice->gl.GetNamedBufferSubData(mPlanes.id(),
                                      static_cast<GLintptr>(kVotePlanes * mPlaneBytes),
                                      static_cast<GLsizeiptr>(mGridBytes), bits->words().data());
    return bits;
}

} // namespace lamina
