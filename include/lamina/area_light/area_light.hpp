#pragma once

#include <lamina/area_light/light_source.hpp>
#include <lamina/area_light/virtual_lights.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/voxelize/epipolar_grid.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/light_depth_map.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lamina {

/// Where the shadow maps of virtual lights come from, when prepare() is given geometry.
enum class ShadowMaps : std::uint8_t {
    Automatic, ///< Imperfect for more than 16 virtual lights.
    Rendered,  ///< The geometry is drawn for each.
    /// Point samples of the geometry are splatted for all at once ([WD13] 3.1.2), each map a layer
    /// of one texture. Maps cover the half-space that an emitter shines into; for lights that shine
    /// alike in all directions (point and spot lights) maps are rendered instead.
    Imperfect,
};

/// How shadow volumes are made.
enum class ShadowVolumeLayout : std::uint8_t {
    Tiled,    ///< All in one texture, by one pass a stage ([WD13] 3.1).
    Separate, ///< Each by its own passes: the naive way of [WD13] 3, for comparison.
};

/// How the visibility along an eye ray becomes airlight.
enum class AirlightForm : std::uint8_t {
    Weighted, ///< The integral of the voxelized visibility, each run of samples by its part in it.
    Factored, ///< Mean visibility times unshadowed airlight ([WD13] 2.1).
};

/// For which pixels and lights sums are gathered ([WD13] 3.4). The filters of Interleaved and
/// Quarter tell surfaces apart, not light: edges of light and shadow on them blur by a pixel or
/// two, as does fog on rays through the light itself.
enum class GatherMode : std::uint8_t {
    Full,
    /// A ninth of the lights a pixel, then a bilateral filter over 3 x 3 pixels. Fewer than 9
    /// lights, and those of ShadowVolumeLayout::Separate, are all gathered at every pixel.
    Interleaved,
    Quarter, ///< Every second pixel in x and y, then a bilateral upsample.
};

/// Point samples of the geometry, from which imperfect shadow maps are made.
struct ImperfectMaps {
    std::uint32_t points = 1u << 17u;       ///< Of all the geometry; 1024 to 2^24.
    std::uint32_t pointsPerMap = 1u << 13u; ///< A random share of them that each map is made of.
    /// Holes of up to about 2^this texels are filled; 0 (none) to 13.
    std::uint32_t holeLevels = 2;
};

struct AreaLightDesc {
    std::uint32_t virtualLights = 256; ///< Of an area light; 1 to 1024.
    /// Of each shadow volume, along alpha, theta and phi; up to 2048, 2^14 and 2^16. One light
    /// alone wants 512 of each ([WD13] 3.2).
    glm::uvec3 voxels{128};
    std::uint32_t mapTexels = 128; ///< A side of each shadow map.
    ShadowMaps maps = ShadowMaps::Automatic;
    ImperfectMaps imperfect;
    ShadowVolumeLayout layout = ShadowVolumeLayout::Tiled;
    AirlightForm airlight = AirlightForm::Weighted;
    GatherMode gather = GatherMode::Full;
    bool interpolate = true; ///< Between samples of theta, and for surfaces of phi.
    bool jitter = true;      ///< Shift the volumes of a light's virtual lights against each other.

    /// Phi samples in a texel: 128, or 127 for devices that lose the last bit ([WD13] 5).
    std::uint32_t bitsPerTexel = 128;
    /// Voxels by which surface points are moved from light and eye before the look-up.
    double alphaBias = -2.25;
    double phiBias = -1.0;
    /// Eye rays within this many alpha voxels of a light take the epipole rule ([WD13] 5).
    double epipoleVoxels = 1.0;

    /// Phong's highlights of surfaces.
    float specularExponent = 32.0f;
    float specularStrength = 0.0f;
    /// GLSL that replaces Lambert and Phong: `vec3 laminaSurfaceReflectance(vec3 normal, vec3
    /// toLight, vec3 toViewer)`, reflected radiance per irradiance for an albedo of 1, cosine left
    /// out; unit vectors from the surface. Empty: none. Its names must not begin with `lamina`
    /// otherwise.
    std::string surfaceReflectance;

    /// Distance from the eye of the farthest visible point; 0: of the view's far plane.
    double farDistance = 0.0;
    /// Distance at which the sky stands: the medium between is seen and dims it. 0: infinitely far.
    double skyDistance = 0.0;
    /// Measure GPU times of the stages (AreaLight::times()).
    /// Software renderers, whose timers see no compute work, then wait after every stage.
    bool measure = false;
};

/// The engine's textures that apply() reads, 2D, of the view's size, single-sampled.
struct SurfaceTextures {
    std::uint32_t depth = 0; ///< A depth format, or a float one with window depths in red.
    /// World normals in RGB; 0: surfaces get no light from here, and their planes, where the fog
    /// ends, are taken from the depths.
    std::uint32_t normal = 0;
    bool unsignedNormals = false; ///< Normals are stored as n / 2 + 1 / 2.
    std::uint32_t albedo = 0;     ///< Linear; 0: white.
    std::uint32_t color = 0; ///< Light of other sources that leaves the surfaces, linear; 0: black.
};

/// What prepare() did; known without waiting for the GPU.
struct AreaLightStats {
    std::uint32_t virtualLights = 0;
    std::uint32_t shadowMaps = 0;  ///< Drawn or splatted by the call.
    std::uint64_t volumeBytes = 0; ///< GL memory of shadow volumes.
    std::uint64_t mapBytes = 0;    ///< Of shadow maps, point samples and captured triangles.
    std::uint64_t targetBytes = 0; ///< Of the sums and the picture.
};

enum class AreaLightStage : std::uint8_t {
    Lights,   ///< Strength of the virtual lights.
    Maps,     ///< Shadow maps: drawn, or point samples, splats and hole filling.
    Voxelize, ///< Rectification; of ShadowVolumeLayout::Separate and drawn maps, their drawing too.
    Scan,
    Gather,
    Composite,
};
inline constexpr std::size_t kAreaLightStageCount = 6;
[[nodiscard]] LAMINA_API std::string_view name(AreaLightStage stage);

/// GPU milliseconds of each stage of the latest frame whose times have arrived; 0 before the first
/// and for stages that had nothing to do.
using AreaLightTimes = std::array<double, kAreaLightStageCount>;

/// Soft shadows of lights in homogeneous, singly scattering media, on surfaces and in the medium
/// itself ([WD13]): imperfect voxelized shadow volumes of many virtual point lights, or one
/// precise volume of a point, spot or directional light.
///
/// Each frame: prepare(), then apply(). Move-only; see Device for threads, lifetime and GL state.
/// Both calls leave the GL state as it was and do not wait for the GPU. Memory is allocated again
/// only for more or larger lights, maps, volumes or views than ever before.
class LAMINA_API AreaLight {
public:
    /// Errors: InvalidArgument (a desc out of range), ShaderError.
    /// Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<AreaLight> create(const Device& device,
                                                  const AreaLightDesc& desc = {});

    AreaLight(AreaLight&&) noexcept;
    AreaLight& operator=(AreaLight&&) noexcept;
    ~AreaLight();

    /// Makes the shadow volumes of this frame from geometry.
    /// Point and spot lights stand within 1e15 of the eye.
    /// view: perspective; its far plane may be infinite if the desc gives a farDistance.
    /// Errors: InvalidArgument (view, medium or light unsound, a MeshView that does not fit its
    /// buffers, a light at the eye), DeviceLimit, OutOfMemory, ShaderError; apply() then still has
    /// the lights and volumes of the last frame, unless memory for other volumes came first.
    /// Memory is found before any work on the GPU starts (but for ShadowVolumeLayout::Separate, and
    /// for what a DrawSource without maxTriangles draws). Cost: for Imperfect maps a capture of the
    /// geometry and work by the number of points; for Rendered ones a draw of the geometry for each
    /// virtual light and more.
    [[nodiscard]] Result<AreaLightStats> prepare(const View& view, const LightSource& light,
                                                 const Medium& medium,
                                                 std::span<const GeometrySource> sources);
    /// The same from the host's shadow maps, one a virtual light, in the order of
    /// sampleVirtualLights().
    [[nodiscard]] Result<AreaLightStats> prepare(const View& view, const LightSource& light,
                                                 const Medium& medium,
                                                 std::span<const LightDepthMap> maps);

    /// Lights what a view shows: color * T + albedo * light * T + airlight, T the transmittance of
    /// the way to the eye. Returns the GL name of a texture of ours, RGBA16F, linear, of the view's
    /// size, valid until the next call or the end of this object; its alpha is that of `color`.
    /// view: looks from the same point as prepare()'s.
    /// surfaces: none is the texture that the last call returned, which is drawn to again: copy it.
    /// Errors: InvalidArgument (no prepare() before, a depth texture missing, a texture of another
    /// size or of integers, another viewpoint), OutOfMemory, ShaderError. GL: textures written as
    /// images need GL_TEXTURE_FETCH_BARRIER_BIT before the call; the result needs none after it.
    [[nodiscard]] Result<std::uint32_t> apply(const View& view, const SurfaceTextures& surfaces);
    /// The same into level 0 of the host's 2D texture of a colour-renderable float or normalized
    /// format. Errors: also of such a texture, or if it is one of `surfaces`.
    [[nodiscard]] Result<void> apply(const View& view, const SurfaceTextures& surfaces,
                                     std::uint32_t target);

    /// Binds what lamina/area_light.glsl reads: shadow volumes (LAMINA_EPIPOLAR_BLOCK_BINDING,
    /// LAMINA_EPIPOLAR_TEXTURE_UNIT) and lights (LAMINA_AREA_LIGHT_BLOCK_BINDING). Nothing before
    /// prepare(), or with ShadowVolumeLayout::Separate. GL: the caller restores these bindings.
    void bind(std::uint32_t volumeBinding, std::uint32_t volumeUnit,
              std::uint32_t lightBinding) const;

    /// Of the last prepare().
    [[nodiscard]] std::span<const VirtualLight> virtualLights() const;
    /// The shadow volumes of the last prepare(): one grid, or one for each virtual light. Before it
    /// one grid without volumes, or none with ShadowVolumeLayout::Separate.
    [[nodiscard]] std::span<const EpipolarGrid> volumes() const;
    /// Times of a frame a little ago, if the desc asks for them; does not wait.
    [[nodiscard]] AreaLightTimes times();
    /// GL names of the gathered airlight and surface light before filtering, RGBA32F, of the view's
    /// size; for GatherMode::Quarter of half of it, rounded up. 0 before apply(). Surface light is
    /// reflected radiance for an albedo of 1: it holds the cosine and Lambert's 1 / pi (or what
    /// surfaceReflectance gives).
    [[nodiscard]] std::array<std::uint32_t, 2> sums() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit AreaLight(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
