#pragma once

#include <lamina/core/box.hpp>
#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/voxelize/epipolar_transform.hpp>
#include <lamina/voxelize/geometry_source.hpp>
#include <lamina/voxelize/light_depth_map.hpp>
#include <lamina/voxelize/material.hpp>

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lamina {

/// A light whose rays leaves let through in part.
struct TransmittanceLight {
    LightKind kind = LightKind::Directional;
    glm::dvec3 position{0.0}; ///< Point and Spot; world space.
    /// Spot and Directional: where the light goes; any length.
    glm::dvec3 direction{0.0, -1.0, 0.0};
    /// Spot: from the axis to the rim, radians in (0, 1.4]. No light reaches points outside.
    double coneAngle = 0.5;
    /// Point and Spot: casters nearer than this cast no shadow; world units, above 0.
    double near = 0.01;
};

/// What a semi-transparent surface does to light.
enum class TransmittanceModel : std::uint8_t {
    /// T = (1 - sigma)^n over the n leaves that a slicemap counts before a point ([ED06] 3.1).
    LeafCount,
    /// T = exp(-sum of alpha) over the voxels of a volume before a point, alpha the sum of the
    /// material absorption of a voxel's hits ([CLN11] 3); or its linear form.
    Absorption,
};

struct TransmittanceDesc {
    TransmittanceModel model = TransmittanceModel::LeafCount;
    /// Columns x, columns y and slices of each grid.
    glm::uvec3 size{512, 512, 128};
    /// LeafCount: slices divide the near/far range of each column ([ED06] 2.3), which resolves more
    /// at the cost of a further pass over the leaves.
    bool localRanges = false;
    /// LeafCount: leaf colours, 1 to 8, each with a slicemap of its own made in the same pass;
    /// Material::colorClass tells which one takes a leaf. Each class costs 16 bytes a column, face
    /// and 128 slices (and as much once more for the face that is being made), a copy of as much
    /// in prepare(), and in look-ups a read of as many columns as the first.
    std::uint32_t classes = 1;
    /// Perspective grids of a light, 1 to 6. One serves every directional and spot light, and a
    /// point light that sees all casters within 50 degrees of one direction; any other point light
    /// needs 6. Each is a further pass over the leaves and over the opaque casters; a look-up
    /// reads one of them.
    std::uint32_t maxFaces = 1;
    /// Texels a side of the opaque shadow map of each face.
    std::uint32_t opaqueMapTexels = 1024;
};

/// How the slices of a column are looked up.
enum class SliceLookup : std::uint8_t {
    /// The set slices before the one that holds the point, as [ED06] do: their exact count, so T
    /// never grows along a ray of the light. Changes in steps.
    Sampled,
    /// Linear between slices: moving points see no steps. The slice that holds the point, and the
    /// part of the one before it that lies within one slice of the point, may be the point's own
    /// surface and are not read: what they hold is estimated from the two slices before. Exact
    /// (equal to Sampled) where the three slices before the point's are empty; elsewhere counts of
    /// leaves are within 1 of Sampled's. Where leaves begin or end the estimate overshoots: behind
    /// a single leaf the count rises to 1.5, stays there for a slice and falls to 1 over the next,
    /// so T is not monotone along a ray.
    Linear,
};

enum class AbsorptionForm : std::uint8_t {
    Exponential, ///< T = exp(-sum)
    Linear,      ///< T = max(0, 1 - sum)
};

/// What may change from frame to frame without building maps again.
struct TransmittanceSettings {
    static constexpr std::size_t kMaxClasses = 8;

    TransmittanceSettings() { attenuation.fill(glm::vec3(0.1f)); }

    /// LeafCount: sigma of each class, the share of red, green and blue light that a leaf takes,
    /// in [0,1].
    std::array<glm::vec3, kMaxClasses> attenuation;
    SliceLookup slices = SliceLookup::Linear;
    /// Width of the box, in columns, over which counts are averaged around a point, 0 to 7. 0: the
    /// one column that holds the point. 1: bilinear.
    float filterWidth = 1.0f;
    /// The same for the opaque shadow map, in its texels; 0: the nearest texel.
    float opaqueFilterWidth = 2.0f;
    /// Points are looked up so much nearer to the light, world units; nothing: 1/5000 of the depth
    /// that the grid spans for leaves, 1/1000 for opaque casters. Where the surface's normal is
    /// known each column is looked up at the depth of the surface's plane in its centre, so that
    /// steep surfaces need no more.
    std::optional<float> depthBias;
    /// Absorption: factor of every alpha, >= 0, and the form.
    float absorptionScale = 1.0f;
    AbsorptionForm absorptionForm = AbsorptionForm::Exponential;
};

/// What casts shadows in a frame. Borrowed for the call.
struct TransmittanceCasters {
    std::span<const GeometrySource> leaves; ///< Semi-transparent.
    /// Decide before the leaves do: a point behind them gets no light.
    std::span<const GeometrySource> opaque;
    /// The host's own shadow map of the opaque casters instead of `opaque`; null: none. Copied.
    const LightDepthMap* opaqueMap = nullptr;
    /// By material id: colour classes (LeafCount), absorption (Absorption; both leaves and opaque
    /// casters fill the volume). None: the default Material alone.
    std::span<const Material> materials;
    /// A world box that holds all casters. The tighter, the finer the voxels.
    Box3 bounds;
};

/// What one prepare() call did; known without waiting for the GPU.
struct TransmittanceStats {
    std::uint32_t faces = 0;         ///< Grids around the light.
    std::uint32_t passes = 0;        ///< Passes over the leaves, all faces together.
    std::uint64_t meshTriangles = 0; ///< Triangles of MeshView leaves, once.
    std::uint64_t gpuBytes = 0;      ///< GL memory held.
};

enum class NormalEncoding : std::uint8_t {
    Signed,   ///< World-space x, y, z as they are (float and SNORM formats).
    Unsigned, ///< (x, y, z) * 0.5 + 0.5 (UNORM formats).
};

/// What an engine has drawn, to be shaded.
struct TransmittanceReceiver {
    View view;
    /// GL name of the depth buffer, a 2D texture of view.size: a depth format, or a float one that
    /// holds window depths in red. Its filter, wrap and compare modes do not matter.
    std::uint32_t depthTexture = 0;
    /// GL name of a 2D texture of view.size with world-space normals of any length; 0: they are
    /// found from the depths of neighbouring pixels.
    std::uint32_t normalTexture = 0;
    NormalEncoding normalEncoding = NormalEncoding::Signed;
};

/// Transmittance shadows: how much of a light's light reaches a point through leaves.
///
/// prepare() builds the maps of one light for a frame, apply() shades what the engine has drawn,
/// and `#include <lamina/transmittance.glsl>` gives the same numbers in the engine's own shaders.
/// T is a colour in [0,1]: 1 before the nearest leaf and outside the casters' bounds as the light
/// sees them, 0 behind opaque casters and outside a spot's cone. Move-only; see Device for threads,
/// lifetime and GL state.
class LAMINA_API Transmittance {
public:
    /// Errors: InvalidArgument (a value in `desc` out of range), DeviceLimit, OutOfMemory,
    /// ShaderError. Sizes that the device cannot serve are found by prepare(), which allocates the
    /// maps. Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<Transmittance> create(const Device& device,
                                                      const TransmittanceDesc& desc = {});

    Transmittance(Transmittance&&) noexcept;
    Transmittance& operator=(Transmittance&&) noexcept;
    ~Transmittance();

    /// Errors: InvalidArgument (a value out of range); the settings are then unchanged. Cost: a
    /// small buffer upload with the next call that needs it.
    [[nodiscard]] Result<void> setSettings(const TransmittanceSettings& settings);
    [[nodiscard]] const TransmittanceSettings& settings() const;

    /// Builds the maps of `light` for this frame. Does not wait for the GPU.
    /// Errors: InvalidArgument (light, bounds that are empty, not finite or beyond 1e18, sources
    /// and materials as Voxelizer::voxelize() says, a host map that does not fit, of a kind other
    /// than 2D, array and cube or of a matrix that is not finite or has no inverse), DeviceLimit (a
    /// point light that needs more faces than desc.maxFaces, a desc too large for the device),
    /// OutOfMemory, ShaderError; the maps are then undefined and must be prepared again.
    /// GL: as Voxelizer::voxelize(); a host map written by shaders needs
    /// GL_TEXTURE_UPDATE_BARRIER_BIT. Cost: LeafCount one pass over the leaves for each face
    /// (one more with local ranges), Absorption one over leaves and opaque casters and a scan of
    /// the volume; one over the opaque casters.
    [[nodiscard]] Result<TransmittanceStats> prepare(const TransmittanceLight& light,
                                                     const TransmittanceCasters& casters);

    /// Shades every pixel: T in red, green and blue of a GL_RGBA16F texture of view.size that this
    /// object owns (alpha is 1), whose name is returned; it is valid until the next apply() with
    /// another size. Pixels of the background get 1.
    /// Errors: InvalidArgument (before prepare(), view, textures that do not exist or fit),
    /// DeviceLimit, OutOfMemory. GL: leaves the state alone; depth and normals written by shaders
    /// need GL_TEXTURE_FETCH_BARRIER_BIT. Cost: a full-screen pass.
    [[nodiscard]] Result<std::uint32_t> apply(const TransmittanceReceiver& receiver);
    /// The same into level 0 of the host's 2D texture of a colour-renderable float or normalized
    /// format. InvalidArgument too for a target that is the receiver's depth or normal texture: a
    /// pass cannot draw to what it reads.
    [[nodiscard]] Result<void> apply(const TransmittanceReceiver& receiver, std::uint32_t target);

    /// The `#define` lines with which a shader of the engine must include
    /// lamina/transmittance.glsl, to go with bind() of the same numbers. They stay the same for the
    /// life of the object. Uniform buffer bindings [uniformBufferBinding, + uniformBufferCount())
    /// and texture units [textureUnit, + textureUnitCount()) are taken.
    [[nodiscard]] std::string shaderDefines(std::uint32_t uniformBufferBinding = 0,
                                            std::uint32_t textureUnit = 0) const;
    [[nodiscard]] std::uint32_t uniformBufferCount() const;
    [[nodiscard]] std::uint32_t textureUnitCount() const;
    /// Binds what lamina/transmittance.glsl reads. Does nothing before prepare(). GL: these uniform
    /// buffer and texture bindings (and the units' samplers) are what it changes; the caller
    /// restores them if need be.
    void bind(std::uint32_t uniformBufferBinding = 0, std::uint32_t textureUnit = 0);

    [[nodiscard]] const TransmittanceDesc& desc() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit Transmittance(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
