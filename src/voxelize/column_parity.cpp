#include "voxelize/column_parity.hpp"

#include "gl/state_guard.hpp"

#include <lamina/shared/constants.glsl>

#include <bit>

namespace lamina {
namespace {

constexpr std::uint32_t kColumnsPerTexel = 32;

} // namespace

Result<void> ColumnParity::reserve(const glm::uvec3& size) {
    const glm::uvec2 texels{(size.x + kColumnsPerTexel - 1) / kColumnsPerTexel, size.y};
    if (texels == mSize)
        return {};
    auto bits = gl::createTextureArray(mDevice, GL_R32UI, sizeof(GLuint), texels.x, texels.y, 1,
                                       "voxelize: parity of columns", "lamina parity of columns");
    if (!bits)
        return bits.error();
    mBits = std::move(*bits);
    mSize = texels;
    mHasReport = false;
    return {};
}

void ColumnParity::begin() {
    const GladGLContext& gl = mDevice->gl;
    gl.ClearTexImage(mBits.id(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    gl.BindImageTexture(LAMINA_COLUMN_PARITY_IMAGE, mBits.id(), 0, GL_FALSE, 0, GL_READ_WRITE,
                        GL_R32UI);
}

void ColumnParity::end() {
    mDevice->gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    mHasReport = true;
}

Result<SolidReport> ColumnParity::download() const {
    if (!mHasReport)
        return Error{ErrorCode::InvalidArgument,
                     "solid report: expected voxels, found none; voxelize first"};
    const gl::DebugGroup group(*mDevice, "lamina: download solid report");
    const gl::PixelPackGuard guard(*mDevice);
    std::vector<GLuint> words(std::size_t{mSize.x} * mSize.y);
    mDevice->gl.GetTextureImage(mBits.id(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                                static_cast<GLsizei>(words.size() * sizeof(GLuint)), words.data());
    SolidReport report;
    for (const GLuint word : words)
        report.oddColumns += static_cast<std::uint64_t>(std::popcount(word));
    return report;
}

} // namespace lamina
