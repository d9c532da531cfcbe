#include "transmittance/absorption_sums.hpp"

#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "grid/grid_constants.hpp"

namespace lamina {

AbsorptionSums::AbsorptionSums(const Device& device, VolumeVoxelizer voxelizer, VolumeGrid volume)
    : mDevice(device.state())
    , mVoxelizer(std::move(voxelizer))
    , mVolume(std::move(volume)) {}

Result<AbsorptionSums> AbsorptionSums::create(const Device& device, std::uint32_t maxFaces) {
    auto voxelizer = VolumeVoxelizer::create(device);
    if (!voxelizer)
        return voxelizer.error();
    VolumeLayout layout;
    layout.count = VolumeFormat::None;
    layout.absorption = VolumeFormat::R32F;
    auto volume = VolumeGrid::create(device, layout);
    if (!volume)
        return volume.error();
    AbsorptionSums sums(device, std::move(*voxelizer), std::move(*volume));
    const auto program = gl::findOrBuildProgram(
        *sums.mDevice, {"lamina absorption scan",
                        {{GL_COMPUTE_SHADER, "transmittance/absorption_scan.comp"}},
                        {}});
    if (!program)
        return program.error();
    sums.mProgram = *program;
    for (std::uint32_t face = 0; face < maxFaces; ++face) {
        auto block =
            gl::createBuffer(sums.mDevice, sizeof(GridBlock), nullptr, GL_DYNAMIC_STORAGE_BIT,
                             "transmittance", "lamina transmittance grid");
        if (!block)
            return block.error();
        sums.mGridBlocks.push_back(std::move(*block));
    }
    return sums;
}

Result<void> AbsorptionSums::reserve(const glm::uvec3& size) {
    if (size == mSize)
        return {};
    auto texture =
        gl::createTexture3d(mDevice, GL_R32F, sizeof(float), size.x, size.y, size.z,
                            "transmittance: absorption of all faces", "lamina absorption sums");
    if (!texture)
        return texture.error();
    mSums = std::move(*texture);
    mSize = size;
    return {};
}

void AbsorptionSums::scan(const glm::uvec3& size, std::size_t face) {
    const GladGLContext& gl = mDevice->gl;
    const gl::ComputeStateGuard guard(*mDevice, 0, 0);
    const gl::TextureUnitGuard textures(*mDevice, 0, 1);
    const gl::ImageUnitGuard images(*mDevice, 1);
    gl.UseProgram(mProgram);
    gl.ProgramUniform1i(mProgram, 0, static_cast<GLint>(face * size.z));
    gl.BindTextureUnit(0, mVolume.texture(VolumePayload::Absorption));
    gl.BindSampler(0, 0);
    gl.BindImageTexture(0, mSums.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32F);
    gl.DispatchCompute((size.x + 7) / 8, (size.y + 7) / 8, 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

Result<VolumeStats> AbsorptionSums::build(std::span<const GeometrySource> sources,
                                          std::span<const Material> materials,
                                          const LightFaces& faces) {
    const glm::uvec3 size = faces.grids.front().size();
    if (auto reserved =
            reserve({size.x, size.y, size.z * static_cast<std::uint32_t>(faces.grids.size())});
        !reserved)
        return reserved.error();
    VolumeStats stats;
    for (std::size_t face = 0; face < faces.grids.size(); ++face) {
        auto voxelized = mVoxelizer.voxelize(sources, materials, faces.grids[face], mVolume);
        if (!voxelized)
            return voxelized.error();
        stats.passes += voxelized->passes;
        stats.meshTriangles = voxelized->meshTriangles;
        stats.scratchBytes = voxelized->scratchBytes;
        const GridBlock block = makeGridBlock(faces.grids[face]);
        mDevice->gl.NamedBufferSubData(mGridBlocks[face].id(), 0, sizeof block, &block);
        scan(size, face);
    }
    return stats;
}

std::uint64_t AbsorptionSums::gpuBytes() const {
    std::uint64_t bytes = mVolume.gpuBytes() + mSums.bytes();
    for (const gl::Buffer& block : mGridBlocks)
        bytes += block.bytes();
    return bytes;
}

} // namespace lamina
