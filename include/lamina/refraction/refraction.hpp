#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/refraction/environment.hpp>
#include <lamina/refraction/thickness_map.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/material.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace lamina {

/// How light is followed through an object.
enum class RefractionModel : std::uint8_t {
    /// Bent once, by the length of the straight ray inside ([ED06] 3.3). Cheapest; a ThicknessMap
    /// from each view.
    VolumeIntegral,
    /// Bent where it enters and where it first meets a surface again, by that one's normal and
    /// index
    /// (Wyman 2005, [CLN11] 4.1). A volume of voxels, from no particular view.
    TwoSurfaces,
    /// Bent at every surface it meets, with total internal reflection and materials within each
    /// other ([CLN11] 4.1.1). The same volume. Only the first surface mirrors: no share of the
    /// light is split off at the others.
    ManySurfaces,
};

struct RefractionDesc {
    RefractionModel model = RefractionModel::VolumeIntegral;
    ThicknessDesc thickness{}; ///< VolumeIntegral.
    /// TwoSurfaces, ManySurfaces: voxels a side of the cube around the object, 8 to 1024. Memory:
    /// about 25 bytes a voxel, 41 where materials differ.
    std::uint32_t voxels = 128;
    /// How far each slice reaches into its neighbours, in slices, from 0 to 1 ([CLN11] 4.1.1). The
    /// volume is made along three axes and has no gaps without; it thickens thin surfaces.
    float slabOverlap = 0.0f;
};

enum class AttenuationModel : std::uint8_t {
    BeerLambert, ///< exp(-absorption * length): clear, coloured bodies.
    /// Opacity (length / opaqueLength) ^ exponent towards the body's own colour: milky ones
    /// ([ED06]).
    Power,
};

/// What may change from frame to frame without building maps again.
struct RefractionSettings {
    /// Of the inside, 1 to 4. TwoSurfaces and ManySurfaces take the materials' instead.
    float refractiveIndex = 1.5f;
    /// Scale of the Fresnel reflection of the environment, 0 to 1.
    float reflection = 1.0f;
    /// VolumeIntegral: length inside, world units, after which the direction is fully bent, and
    /// less before; 0: it is always.
    float bendLength = 0.0f;
    AttenuationModel attenuation = AttenuationModel::BeerLambert;
    glm::vec3 absorption{0.0f}; ///< BeerLambert: of red, green, blue per world unit, >= 0.
    glm::vec3 bodyColor{1.0f};  ///< Power: linear colour, >= 0.
    float opaqueLength = 1.0f;  ///< Power: world units, > 0.
    float exponent = 1.0f;      ///< Power: > 0.
    /// Standard deviation, in radians, by which the surface blurs what is seen through or in it
    /// (frosted glass), and by which each world unit inside does (wax, jade); >= 0.
    float surfaceBlur = 0.0f;
    float bodyBlur = 0.0f;
    /// World distance from where a ray leaves the object to what RefractionReceiver::colorTexture
    /// shows, >= 0.
    float behindDistance = 1.0f;
    /// ManySurfaces: surfaces met after the first one, at most; 1 to 64.
    std::uint32_t maxEvents = 12;
    /// TwoSurfaces, ManySurfaces: voxels along a ray whose normals differ by less are one surface;
    /// radians in (0, pi/2].
    float sameSurfaceAngle = 0.6f;
};

/// What refracts in a frame. Borrowed for the call.
struct RefractionObject {
    /// Closed surfaces. What is outside: VolumeIntegral goes by the triangles, which turn
    /// counter-clockwise in world space as seen from there; TwoSurfaces and ManySurfaces by the
    /// vertex normals, which point there, or by the triangles where there are none.
    std::span<const GeometrySource> sources;
    /// TwoSurfaces, ManySurfaces: by material id: refractiveIndex, 1 to 4, and transmission times
    /// color is the share of light left after one world unit inside. A material begins at the front
    /// of a surface and ends at its back; surfaces within others hold other materials. None: the
    /// default Material alone.
    std::span<const Material> materials;
    /// A world box that holds the sources; the tighter, the finer the voxels. TwoSurfaces,
    /// ManySurfaces: within 1e15 of the origin, its longest side at least 1e-15.
    Box3 bounds;
};

/// What one prepare() call did; known without waiting for the GPU.
struct RefractionStats {
    std::uint32_t passes = 0;        ///< Passes over the geometry.
    std::uint64_t meshTriangles = 0; ///< Triangles of the MeshView sources.
    std::uint64_t gpuBytes = 0;      ///< GL memory held.
};

/// How far the picture can be trusted.
struct RefractionReport {
    /// Pixels that tell of an open surface: VolumeIntegral: ThicknessReport::openColumns of the
    /// last prepare(). The others: of the last apply(), rays that met a back face from outside or
    /// never left the object. Closed surfaces give none or a few in a hundred, where voxels are too
    /// coarse for edges and walls; where an open one is open, each of its pixels.
    std::uint64_t openPixels = 0;
};

/// What an engine has drawn of the objects' front surfaces. 2D textures of view.size.
struct RefractionReceiver {
    View view;
    /// GL name of the depth buffer, a depth format or a float one that holds window depths in red.
    std::uint32_t depthTexture = 0;
    /// World-space normals of any length, outward; as x, y, z, or x, y, z * 0.5 + 0.5.
    std::uint32_t normalTexture = 0;
    bool unsignedNormals = false;
    /// Which object a pixel shows, an unsigned integer format; 0: all pixels but the background are
    /// this one's.
    std::uint32_t objectTexture = 0;
    std::uint32_t objectId = 0; ///< This object's number there.
    /// Linear colours of what lies behind the objects; 0: only the environment does. Copied: it may
    /// also be the target.
    std::uint32_t colorTexture = 0;
    /// Depths of what colorTexture shows, so that what stands before an object is not seen through
    /// it; 0: nothing does.
    std::uint32_t colorDepthTexture = 0;
};

/// Glass, jade, frosted and coloured bodies of any closed shape, which may deform every frame.
///
/// prepare() builds the maps of one object for a frame, apply() shades its pixels of a G-buffer,
/// and
/// `#include <lamina/refraction.glsl>` gives the same in the engine's own shaders. Several objects
/// take turns with one Refraction, or have one each, and draw into the same target. Move-only; see
/// Device for threads, lifetime and GL state.
class LAMINA_API Refraction {
public:
    /// Errors: InvalidArgument (a number in `desc` out of range), Unsupported, OutOfMemory,
    /// ShaderError. Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<Refraction> create(const Device& device,
                                                   const RefractionDesc& desc = {});

    Refraction(Refraction&&) noexcept;
    Refraction& operator=(Refraction&&) noexcept;
    ~Refraction();

    /// Errors: InvalidArgument (a value out of range); the settings are then unchanged.
    [[nodiscard]] Result<void> setSettings(const RefractionSettings& settings);
    [[nodiscard]] const RefractionSettings& settings() const;
    /// Surroundings from now on; must outlive their use here.
    void setEnvironment(const Environment& environment);

    /// Builds the maps of an object as seen by `view` (TwoSurfaces and ManySurfaces: for every
    /// view). Does not wait for the GPU.
    /// Errors: those of ThicknessMap::build() or VolumeVoxelizer::voxelize(); the maps are then
    /// undefined and must be prepared again. GL: as Voxelizer::voxelize(). Cost: VolumeIntegral see
    /// ThicknessMap::build(); the others three passes over the geometry that draw each triangle in
    /// its slices, and a pass over the voxels for each.
    [[nodiscard]] Result<RefractionStats> prepare(const RefractionObject& object, const View& view);

    /// Shades the object's pixels: linear colours, alpha 1, in a GL_RGBA16F texture of view.size
    /// that this object owns and whose name is returned; all other pixels are 0. It is valid until
    /// the next apply() with another size.
    /// Errors: InvalidArgument (before prepare() or setEnvironment(), view, another size than
    /// prepared for with VolumeIntegral, textures that do not exist or fit), DeviceLimit,
    /// OutOfMemory. GL: leaves the state alone; textures written by shaders need
    /// GL_TEXTURE_FETCH_BARRIER_BIT. Cost: a full-screen pass; with colorTexture also its copy and
    /// mipmaps.
    [[nodiscard]] Result<std::uint32_t> apply(const RefractionReceiver& receiver);
    /// The same into level 0 of the host's 2D texture of a colour-renderable float or normalized
    /// format; pixels that do not show the object keep what they hold. Of the receiver's textures
    /// only colorTexture may be the target; InvalidArgument else.
    [[nodiscard]] Result<void> apply(const RefractionReceiver& receiver, std::uint32_t target);

    /// Of the last prepare() or apply(): an open surface is no error, its pixels are bounded and
    /// finite. Rays of lamina/refraction.glsl tell it themselves. Waits for the GPU.
    /// Errors: InvalidArgument before prepare(), or apply() after it but for VolumeIntegral.
    [[nodiscard]] Result<RefractionReport> downloadReport() const;

    /// The map of the last prepare(); null but for VolumeIntegral.
    [[nodiscard]] const ThicknessMap* thicknessMap() const;

    /// The `#define` lines with which a shader of the engine must include lamina/refraction.glsl,
    /// to go with bind() of the same numbers: one uniform buffer binding, and texture units
    /// [textureUnit, + kTextureUnits). They stay the same for the life of the object.
    [[nodiscard]] std::string shaderDefines(std::uint32_t uniformBufferBinding = 0,
                                            std::uint32_t textureUnit = 0) const;
    static constexpr std::uint32_t kTextureUnits = 6;
    /// Binds what lamina/refraction.glsl reads, for the view and colour texture of the last
    /// apply(), or of prepare() if that came later (without colour texture). Does nothing before
    /// prepare() or setEnvironment(). GL: these bindings (and the units' samplers) are what it
    /// changes; the caller restores them if need be. GL_TEXTURE_CUBE_MAP_SEAMLESS should be on
    /// while the engine's shader runs, or edges show in blurred surroundings; apply() sees to it
    /// itself.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0);

    [[nodiscard]] const RefractionDesc& desc() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit Refraction(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
