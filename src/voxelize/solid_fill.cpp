#include "voxelize/solid_fill.hpp"

#include "gl/program_cache.hpp"

#include <algorithm>

namespace lamina {
namespace {

/// Of the counters before the columns' bits.
constexpr std::uint64_t kHeadBytes = 16;

} // namespace

Result<void> SolidFill::initialize() {
    auto program = gl::findOrBuildProgram(
        *mDevice, {"lamina solid fill", {{GL_COMPUTE_SHADER, "voxelize/solid_fill.comp"}}, {}});
    if (!program)
        return program.error();
    mProgram = *program;
    return {};
}

Result<void> SolidFill::reserve(std::uint64_t columns) {
    const std::uint64_t bytes = kHeadBytes + (columns + 31) / 32 * 4;
    if (mColumns.bytes() >= bytes)
        return {};
    auto buffer = gl::createBuffer(mDevice, bytes, nullptr, 0, "voxelize: solid columns",
                                   "lamina solid columns");
    if (!buffer)
        return buffer.error();
    mColumns = std::move(*buffer);
    mHasReport = false;
    return {};
}

void SolidFill::begin() {
    const GladGLContext& gl = mDevice->gl;
    const GLuint columns = mColumns.id();
    gl.ClearNamedBufferData(columns, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_OVERLAP_COLUMNS_BINDING, 1, &columns);
    mHasReport = true;
}

void SolidFill::fill(const GridPart& part) {
    const GladGLContext& gl = mDevice->gl;
    const auto rows = static_cast<std::uint64_t>(part.high.y - part.low.y + 1);
    const std::uint64_t columns = rows * static_cast<std::uint64_t>(part.high.x + 1);
    const std::uint64_t groups =
        (columns + LAMINA_OVERLAP_GROUP_SIZE - 1) / LAMINA_OVERLAP_GROUP_SIZE;
    constexpr std::uint64_t kMaxGroups = LAMINA_OVERLAP_MAX_GROUPS;
    gl.UseProgram(mProgram);
    gl.DispatchCompute(static_cast<GLuint>(std::min(groups, kMaxGroups)),
                       static_cast<GLuint>((groups + kMaxGroups - 1) / kMaxGroups), 1);
}

Result<SolidReport> SolidFill::download() const {
    if (!mHasReport)
        return Error{ErrorCode::InvalidArgument,
                     "solid report: expected voxels, found none; voxelize first"};
    GLuint oddColumns = 0;
    mDevice->gl.GetNamedBufferSubData(mColumns.id(), 0, sizeof oddColumns, &oddColumns);
    return SolidReport{oddColumns};
}

} // namespace lamina
