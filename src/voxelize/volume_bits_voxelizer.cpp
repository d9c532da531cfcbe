#include "voxelize/volume_bits_voxelizer.hpp"

#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"

#include <lamina/voxelize/volume_voxelizer.hpp>

#include <algorithm>
#include <vector>

namespace lamina {
namespace {

/// One bit for each voxel that a volume counts hits of.
class VolumeBitsVoxelizer final : public Voxelizer {
public:
    VolumeBitsVoxelizer(std::shared_ptr<gl::DeviceState> device, VolumeVoxelizer voxelizer,
                        VolumeGrid volume, GLuint program)
        : mDevice(std::move(device))
        , mVoxelizer(std::move(voxelizer))
        , mVolume(std::move(volume))
        , mProgram(program) {}

    [[nodiscard]] Backend backend() const override { return Backend::Volume; }
    [[nodiscard]] VoxelizerCapabilities capabilities() const override;
    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override;

private:
    void pack(const VoxelGrid& out) const;

    std::shared_ptr<gl::DeviceState> mDevice;
    VolumeVoxelizer mVoxelizer;
    VolumeGrid mVolume;
    GLuint mProgram;
};

VoxelizerCapabilities VolumeBitsVoxelizer::capabilities() const {
    const DeviceLimits& limits = mDevice->limits;
    GLint side = 0, layers = 0;
    mDevice->gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &side);
    mDevice->gl.GetIntegerv(GL_MAX_FRAMEBUFFER_LAYERS, &layers);
    VoxelizerCapabilities capabilities;
    capabilities.maxColumns = std::min({static_cast<std::uint32_t>(side), limits.maxTextureSize,
                                        limits.maxViewportWidth, limits.maxViewportHeight});
    capabilities.maxSlices = static_cast<std::uint32_t>(std::min(side, layers));
    capabilities.slicesPerPass = capabilities.maxSlices;
    capabilities.perspective = true;
    capabilities.anyDistribution = true;
    capabilities.drawSources = true;
    capabilities.store = VoxelStore::Texture;
    return capabilities;
}

/// Bits do not depend on materials, normals and colours, which are then not asked to be valid.
std::vector<GeometrySource> plainSources(std::span<const GeometrySource> sources) {
    std::vector<GeometrySource> plain(sources.begin(), sources.end());
    for (GeometrySource& source : plain)
        if (auto* view = std::get_if<MeshView>(&source)) {
            view->materialId = 0;
            view->normals = {};
            view->colors = {};
        }
    return plain;
}

void VolumeBitsVoxelizer::pack(const VoxelGrid& out) const {
    const GladGLContext& gl = mDevice->gl;
    const glm::uvec3 size = out.transform()->size();
    const gl::ComputeStateGuard guard(*mDevice, 0, 0);
    const gl::TextureUnitGuard textureGuard(*mDevice, 0, 1);
    const gl::ImageUnitGuard imageGuard(*mDevice, 1);
    gl.BindTextureUnit(0, mVolume.texture(VolumePayload::Count));
    gl.BindSampler(0, 0);
    gl.BindImageTexture(0, out.texture(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    gl.UseProgram(mProgram);
    gl.DispatchCompute((size.x + 7) / 8, (size.y + 7) / 8,
                       (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup);
    // For sampling, read-back, and drawing by another backend.
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                     GL_FRAMEBUFFER_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

Result<VoxelizeStats> VolumeBitsVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                    const GridTransform& transform,
                                                    VoxelGrid& out) {
    const gl::DebugGroup group(*mDevice, "lamina: voxelize (volume bits)");
    if (auto own = gl::checkSameDevice(*mDevice, out.deviceState(), "voxelize", "a grid"); !own)
        return own.error();
    const auto made = mVoxelizer.voxelize(plainSources(sources), {}, transform, mVolume);
    if (!made)
        return made.error();
    if (auto resized = out.resize(transform, VoxelStore::Texture); !resized)
        return resized.error();
    pack(out);
    VoxelizeStats stats;
    stats.sources = made->sources;
    stats.passes = made->passes;
    stats.meshTriangles = made->meshTriangles;
    stats.gridBytes = out.gpuBytes();
    return stats;
}

} // namespace

Result<std::unique_ptr<Voxelizer>> createVolumeBitsVoxelizer(const Device& device,
                                                             const VoxelizerDesc&) {
    auto voxelizer = VolumeVoxelizer::create(device);
    if (!voxelizer)
        return voxelizer.error();
    VolumeLayout layout;
    layout.count = VolumeFormat::R8; // any hit counts
    auto volume = VolumeGrid::create(device, layout);
    if (!volume)
        return volume.error();
    auto program = gl::findOrBuildProgram(
        *device.state(),
        {"lamina volume bits", {{GL_COMPUTE_SHADER, "voxelize/volume_bits.comp"}}, {}});
    if (!program)
        return program.error();
    return std::unique_ptr<Voxelizer>(std::make_unique<VolumeBitsVoxelizer>(
        device.state(), std::move(*voxelizer), std::move(*volume), *program));
}

} // namespace lamina
