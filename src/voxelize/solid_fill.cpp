#include "voxelize/solid_fill.hpp"

#include "gl/dispatch.hpp"
#include "gl/program_cache.hpp"

namespace lamina {
namespace {

/// Of the counters before the columns' bits.
constexpr std::uint64_t kHeadBytes = 16;

} // namespace

Result<void> SolidFill::initialize() {
    auto program =
        gl::findOrBuildProgram(*mDevice, {"lamina solid fill",
                                          {{GL_COMPUTE_SHADER, "voxelize/solid_fill.comp"}},
                                          {{"LAMINA_CROSSINGS", "LAMINA_CROSSINGS_PARITY"}}});
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
    gl.UseProgram(mProgram);
    gl::dispatchLinear(gl, part.columns(), LAMINA_OVERLAP_GROUP_SIZE);
}

Result<SolidReport> SolidFill::download() const {
    if (!mHasReport)
        return Error{ErrorCode::InvalidArgument,
                     "solid report: expected voxels, found none; voxelize first"};
    GLuint oddColumns = 0;
    mDevice->gl.GetNamedBufferSubData(mColumns.id(), 0, sizeof oddColumns, &oddColumns);
    SolidReport report;
    report.oddColumns = oddColumns;
    return report;
}

} // namespace lamina
