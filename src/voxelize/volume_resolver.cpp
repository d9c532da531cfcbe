#include "voxelize/volume_resolver.hpp"

#include "gl/program_cache.hpp"
#include "voxelize/volume_formats.hpp"

#include <string>

namespace lamina {
namespace {

std::string_view permutation(VolumePayload payload) {
    constexpr std::array<std::string_view, kVolumePayloadCount> kNames = {
        "", "LAMINA_VOLUME_ABSORPTION", "LAMINA_VOLUME_NORMAL", "LAMINA_VOLUME_COLOR",
        "LAMINA_VOLUME_OPTICS"};
    return kNames[indexOf(payload)];
}

} // namespace

Result<void> VolumeResolver::prepare(const VolumeLayout& layout, const GridTransform& transform) {
    const glm::uvec3 size = transform.size();
    if (size == mSize && layout == mLayout)
        return {};
    std::array<gl::Texture, kVolumePayloadCount> sums;
    std::array<GLuint, kVolumePayloadCount> programs{};
    for (const VolumePayload payload : kVolumePayloads) {
        if (!isResolved(payload, layout.format(payload)))
            continue;
        const auto program = gl::findOrBuildProgram(
            *mDevice, {"lamina volume resolve",
                       {{GL_COMPUTE_SHADER, "voxelize/volume_resolve.comp"}},
                       {{"LAMINA_VOLUME_RESOLVED", std::string(permutation(payload))}}});
        if (!program)
            return program.error();
        programs[indexOf(payload)] = *program;
        const VolumeFormatInfo sum = info(accumulationFormat(payload, layout.format(payload)));
        auto texture = gl::createTexture3d(
            mDevice, sum.internalFormat, sum.bytesPerTexel, size.x, size.y, size.z,
            "volume sums " + transform.describe() + " " + std::string(sum.name),
            "lamina volume sums");
        if (!texture)
            return texture.error();
        sums[indexOf(payload)] = std::move(*texture);
    }
    mSums = std::move(sums);
    mPrograms = programs;
    mLayout = layout;
    mSize = size;
    return {};
}

GLuint VolumeResolver::target(VolumePayload payload, const VolumeGrid& volume) const {
    const gl::Texture& sum = mSums[indexOf(payload)];
    return sum ? sum.id() : volume.texture(payload);
}

void VolumeResolver::resolve(const VolumeGrid& volume) const {
    const GladGLContext& gl = mDevice->gl;
    for (const VolumePayload payload : kVolumePayloads) {
        const gl::Texture& sum = mSums[indexOf(payload)];
        if (!sum)
            continue;
        const VolumeFormat format = mLayout.format(payload);
        gl.BindImageTexture(0, sum.id(), 0, GL_TRUE, 0, GL_READ_ONLY,
                            info(accumulationFormat(payload, format)).internalFormat);
        gl.BindImageTexture(1, volume.texture(payload), 0, GL_TRUE, 0, GL_WRITE_ONLY,
                            info(format).internalFormat);
        gl.UseProgram(mPrograms[indexOf(payload)]);
        gl.DispatchCompute((mSize.x + 7) / 8, (mSize.y + 7) / 8, mSize.z);
    }
}

std::uint64_t VolumeResolver::gpuBytes() const {
    std::uint64_t bytes = 0;
    for (const gl::Texture& sum : mSums)
        bytes += sum.bytes();
    return bytes;
}

} // namespace lamina
