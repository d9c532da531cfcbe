#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/shadow_volumes/shadow_topology.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <glm/vec4.hpp>

#include <bitset>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lamina {

/// How the layers of a caster that hold receivers are found ([ED06] 3.2).
enum class LayerSearch : std::uint8_t {
    /// "Ideal": one draw of each caster ORs the bits of all layers into its mask.
    Reduction,
    /// "Practical": an occlusion query for each caster and layer. The results never come to the
    /// host; the GPU reads them (query buffers). Drivers may wait for them inside. Keeps the layers
    /// that Reduction keeps; but where a triangle passes the limit of a test by less than rounding
    /// the two may differ, without effect on shadows: the limits leave room for it.
    Queries
};

struct ShadowVolumesDesc {
    /// Layers that the view is cut into, 1 to 128.
    std::uint32_t layers = 32;
    /// Texels a side of each face of the light's map (slicemap of receivers and shadow map), 16 to
    /// 8192. More keep fewer layers, and cost 13 + 4 * ceil(layers / 32) bytes a texel, six faces
    /// for a point light.
    std::uint32_t lightMapTexels = 512;
    LayerSearch search = LayerSearch::Reduction;
    /// Do not draw the volumes of casters that lie in the shadow of others.
    bool cullCasters = true;
    /// Draw volumes in the layers alone where a receiver can be in their shadow.
    bool clampLayers = true;
    /// Figure 8, left: parts of a caster behind the light's shadow map ask for no layers. The
    /// shadow map is trusted in texels that no silhouette of its own casters crosses; there a thing
    /// that lies in a pit of another, narrower than a texel, could be missed. Off, as cullCasters
    /// is too, layers are dropped only where no visible point can be in the caster's shadow.
    bool casterDepthTest = true;
    /// Figure 8, right: receivers are the visible points, taken from the depth buffer. Off:
    /// receivers are the geometry in ShadowScene::receivers that the viewer sees any part of.
    bool litmap = true;
    /// Also clip volumes to the strip of their first to last kept layer, which saves rasterization
    /// beside stencil fragments. Shadow edges may then move by the rasterizer's subpixel precision
    /// (1/256 pixel), so that single pixels of a shadow's edge differ from the whole volume's.
    bool clipVolumes = false;
    /// How far in front of a visible surface its shadow is asked for, against acne: in pixels of
    /// the surface's depth slope, and in least steps of the depth buffer. The slope's part is at
    /// most 32 depthBiasSlope widths of the pixel: at gaps between things slopes mean nothing.
    float depthBiasSlope = 0.03125f;
    float depthBiasUnits = 16.0f;
};

/// A thing that casts a shadow. Borrowed from prepare() to the last apply() of the frame.
struct ShadowCaster {
    const ShadowTopology* topology = nullptr;
    /// The mesh as it is in this frame: of the topology's triangles.
    GeometrySource source;
};

/// What prepare() looks at. Borrowed as ShadowCaster is.
struct ShadowScene {
    View view;
    /// The engine's depth buffer of this view: GL name of a 2D texture of a depth format, or of a
    /// float format that holds the depths in red, of view.size texels.
    std::uint32_t depthTexture = 0;
    /// Point light: position, 1. Directional light: direction towards the light (any length), 0.
    /// No other w. World space. A point light may be about 1e5 times as far away as the scene is
    /// large; beyond, float rounding shows in its shadows: use a directional one.
    glm::dvec4 light{0.0, 1.0, 0.0, 0.0};
    std::span<const ShadowCaster> casters;
    /// Everything that the depth buffer shows, casters too, in pieces of any size. Needed without
    /// ShadowVolumesDesc::litmap; with it, only counted in the report, for a pass of their
    /// geometry.
    std::span<const GeometrySource> receivers;
};

/// The part of the shadow volumes that a pass draws.
enum class VolumeExtent : std::uint8_t {
    Kept, ///< As culled and clamped by prepare().
    Whole ///< All of all: the yardstick.
};

/// What prepare() achieved, and what it saved.
struct ShadowVolumesReport {
    std::uint32_t casters = 0;
    std::uint32_t castersCulled = 0;   ///< Volumes not drawn at all.
    std::uint32_t castersShadowed = 0; ///< Of all: those the light sees no part of.
    std::uint32_t receivers = 0;
    std::uint32_t receiversCulled = 0; ///< The viewer sees no part of them.
    std::uint32_t layers = 0;          ///< Of a caster that is not clamped.
    std::uint64_t layersKept = 0;      ///< Of all casters together; of casters * layers.
    /// By caster: bit k is layer k.
    std::vector<std::bitset<128>> keptLayers;
    std::uint64_t stencilFragments = 0;      ///< That reach the stencil buffer, VolumeExtent::Kept.
    std::uint64_t stencilFragmentsWhole = 0; ///< The same for VolumeExtent::Whole.
};

/// Stencil shadow volumes, culled and clamped by a slicemap ([ED06] 3.2; Lloyd et al. 2004).
///
/// The view is cut into layers by planes through the viewpoint, across the light's direction:
/// strips of the picture. From the light, a slicemap tells for each texel which layers hold visible
/// receivers. A caster needs its volume in those layers alone that the texels under it hold. Which
/// they are is found and used on the GPU: nothing is read back.
///
/// Volumes are robust for any viewer: depths compare behind the visible surface (z-fail), and
/// volumes reach to infinity without a far plane. Up to 255 volumes may lie one in another.
/// Move-only; see Device for threads, lifetime and GL state.
///
/// No call waits for the GPU but downloadReport(); none needs a barrier before its textures are
/// read. Depth textures written as images need GL_TEXTURE_FETCH_BARRIER_BIT before prepare().
class LAMINA_API ShadowVolumes {
public:
    /// Errors: InvalidArgument (a desc out of range), OutOfMemory, ShaderError.
    /// Cost: compiles programs (milliseconds).
    [[nodiscard]] static Result<ShadowVolumes> create(const Device& device,
                                                      const ShadowVolumesDesc& desc = {});

    ShadowVolumes(ShadowVolumes&&) noexcept;
    ShadowVolumes& operator=(ShadowVolumes&&) noexcept;
    ~ShadowVolumes();

    /// Finds the casters and layers to draw for this frame. InvalidArgument leaves the frame before
    /// in place, but for a DrawSource that draws too little; after that and after other errors
    /// nothing is prepared.
    /// Errors: InvalidArgument (a view without an inverse, a depth texture of another kind or size,
    /// a light that is nowhere or of a w other than 0 and 1, a caster without topology or with
    /// fewer vertices than it needs, a MeshView that does not fit its buffers, no receivers where
    /// they are needed; an active occlusion query of the host, for LayerSearch::Queries; an active
    /// transform feedback of the host, for DrawSource casters), OutOfMemory, DeviceLimit,
    /// ShaderError. Cost: two passes over the view's pixels, three over the casters' geometry (and
    /// one for each layer with LayerSearch::Queries), and over the receivers' two if they are
    /// geometry.
    [[nodiscard]] Result<void> prepare(const ShadowScene& scene);

    /// Draws the volumes of the last prepare() into a stencil buffer of ours and resolves it into
    /// the texture that it returns: GL name, R8, of the view's size, 1 where light reaches the
    /// visible surface, 0 in shadow, 1 where there is no surface. Ours; valid until the next
    /// prepare() of another view size.
    /// Errors: InvalidArgument (before the first prepare()), OutOfMemory.
    [[nodiscard]] Result<std::uint32_t> apply(VolumeExtent extent = VolumeExtent::Kept);

    /// Draws how many stencil fragments each pixel gets, R32F, of the view's size. As apply().
    [[nodiscard]] Result<std::uint32_t> overdraw(VolumeExtent extent = VolumeExtent::Kept);

    /// Reads back what the last prepare() found. Waits for the GPU, and draws the overdraw of both
    /// extents to count fragments.
    /// Errors: InvalidArgument (before the first prepare()), OutOfMemory.
    [[nodiscard]] Result<ShadowVolumesReport> downloadReport();

    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit ShadowVolumes(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
