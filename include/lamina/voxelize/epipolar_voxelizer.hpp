#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/voxelize/epipolar_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/light_depth_map.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace lamina {

struct EpipolarVoxelizerDesc {
    /// Texels a side of each depth map that the voxelizer draws itself. At least the number of
    /// theta or phi voxels; twice as many keeps thin occluders.
    std::uint32_t depthMapTexels = 1024;
    /// Own depth maps of point and spot lights ignore occluders nearer than this share of the
    /// distance from the light to the eye.
    double nearShare = 1.0 / 4096.0;
};

/// What one call did; known without waiting for the GPU.
struct EpipolarStats {
    std::uint32_t shadowVolumes = 0;
    std::uint32_t depthMaps = 0;  ///< Drawn by the call: one to six a light.
    std::uint32_t batches = 0;    ///< Dispatches of the rectify kernel.
    std::uint64_t gridBytes = 0;  ///< GL memory of the grid.
    std::uint64_t depthBytes = 0; ///< GL memory of the voxelizer's own depth maps.
};

/// Makes voxelized shadow volumes ([WD13] 2.6, 3.1), on the GPU, every frame: depth maps of the
/// lights, from the host or drawn here, are resampled for every (theta, phi), and occlusion is
/// extruded along alpha. A voxel's bit is the visibility at its centre. Any number of shadow
/// volumes takes one dispatch per texture of depth maps and one for the scan. Move-only; see Device
/// for threads, lifetime and GL state.
///
/// Every call leaves the GL state as it was, needs no barrier before the grid is sampled, does not
/// wait for the GPU and leaves `out` unchanged if it fails.
class LAMINA_API EpipolarVoxelizer {
public:
    /// Errors: InvalidArgument (a desc out of range), DeviceLimit, ShaderError.
    /// Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<EpipolarVoxelizer> create(const Device& device,
                                                          const EpipolarVoxelizerDesc& desc = {});

    EpipolarVoxelizer(EpipolarVoxelizer&&) noexcept;
    EpipolarVoxelizer& operator=(EpipolarVoxelizer&&) noexcept;
    ~EpipolarVoxelizer();

    /// Shadow volumes of `sources` for the light and eye of each transform. Draws the depth maps
    /// that each shadow volume needs, fitted to its ranges, at most 256 MiB of them at a time.
    /// Errors: InvalidArgument (transforms of different sizes, a MeshView that does not fit its
    /// buffers, a DrawSource without a draw, a grid of another device), DeviceLimit (over 2048
    /// alpha voxels), OutOfMemory, ShaderError. Cost: a pass of the geometry per depth map, then
    /// the kernel.
    [[nodiscard]] Result<EpipolarStats> voxelize(std::span<const GeometrySource> sources,
                                                 std::span<const EpipolarTransform> transforms,
                                                 EpipolarGrid& out);
    /// The same from the host's depth maps, one a transform. Light rays that miss a 2D map are lit.
    /// Errors: InvalidArgument (another number of maps, a texture of another kind, a part outside
    /// it, a matrix that does not fit the light), DeviceLimit, OutOfMemory, ShaderError. GL: depth
    /// maps written as images need GL_TEXTURE_FETCH_BARRIER_BIT before the call.
    [[nodiscard]] Result<EpipolarStats> voxelize(std::span<const LightDepthMap> maps,
                                                 std::span<const EpipolarTransform> transforms,
                                                 EpipolarGrid& out);

    /// The two halves of voxelize(): only the first shadowed voxel of each light ray is set, for
    /// hosts that add occluders of their own, or measure; then scan().
    [[nodiscard]] Result<EpipolarStats> rectify(std::span<const GeometrySource> sources,
                                                std::span<const EpipolarTransform> transforms,
                                                EpipolarGrid& out);
    [[nodiscard]] Result<EpipolarStats> rectify(std::span<const LightDepthMap> maps,
                                                std::span<const EpipolarTransform> transforms,
                                                EpipolarGrid& out);
    /// Extrudes occlusion away from the lights: every voxel becomes the OR of those of its light
    /// ray up to it, in all shadow volumes, in one dispatch. GL: voxels written by shaders need
    /// GL_SHADER_IMAGE_ACCESS_BARRIER_BIT before the call. Errors: InvalidArgument (a grid without
    /// shadow volumes).
    [[nodiscard]] Result<void> scan(EpipolarGrid& grid);
    /// Bytes of GL memory held: its own depth maps.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit EpipolarVoxelizer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
