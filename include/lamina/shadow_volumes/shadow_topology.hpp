#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <cstdint>
#include <memory>

namespace lamina {

/// Which sides of a caster's triangles cast shadows.
enum class CasterSurface : std::uint8_t {
    Automatic, ///< Closed where the mesh is, else Sheet.
    /// Triangles turned to the light. For closed meshes, counter-clockwise seen from outside, and
    /// lights outside of them. Where the mesh is not closed, back faces do not cast.
    Closed,
    /// Both sides, whatever the winding: open and dirty meshes, lights inside. Open edges bound the
    /// volume as silhouettes do, edges of many triangles, triangles that lie twice or are turned
    /// over count as often as they are there: the shadow is that of the triangles. Where a vertex
    /// of one triangle lies on an edge of another (a T-junction) single pixels along the shadow
    /// of that edge may be wrong. Costs about twice the fill.
    Sheet
};

/// Which triangles of a caster share which edges: what its silhouette is found from. Depends on the
/// triangles alone, not on where the vertices are now: made once for a mesh that moves, bends or
/// stands in the scene many times. Move-only; see Device for threads and lifetime.
class LAMINA_API ShadowTopology {
public:
    /// Reads the mesh of `source` back and joins vertices of equal position, so that seams of
    /// normals or texture coordinates are no edges. Vertices that are equal now must stay equal
    /// when the mesh bends. A DrawSource must draw the same triangles in the same order in every
    /// frame. Degenerate triangles, and those with positions that are not finite, never cast.
    /// Errors: InvalidArgument (a MeshView that does not fit its buffers, a DrawSource without a
    /// draw, no value of CasterSurface), InvalidMesh (indices out of range), OutOfMemory,
    /// ShaderError. GL: waits for the GPU. Cost: a sort of the vertices and of the edges on the
    /// host.
    [[nodiscard]] static Result<ShadowTopology>
    create(const Device& device, const GeometrySource& source,
           CasterSurface surface = CasterSurface::Automatic);

    ShadowTopology(ShadowTopology&&) noexcept;
    ShadowTopology& operator=(ShadowTopology&&) noexcept;
    ~ShadowTopology();

    /// Is every edge shared by as many triangles of one direction as of the other?
    [[nodiscard]] bool isClosed() const;
    /// Closed or Sheet: what was asked for, or found.
    [[nodiscard]] CasterSurface surface() const;
    /// Without degenerate ones.
    [[nodiscard]] std::uint32_t triangleCount() const;
    /// Pairs of triangles, and triangles without another, at an edge.
    [[nodiscard]] std::uint32_t edgeCount() const;
    /// Of these, the edges of one triangle alone, or of two that run along them in one direction:
    /// holes, rims of sheets, triangles of the wrong winding. 0 for closed meshes.
    [[nodiscard]] std::uint32_t openEdgeCount() const;
    /// Vertices that a MeshView with this topology must have.
    [[nodiscard]] std::uint32_t vertexCount() const;
    /// Bytes of GL memory held: 12 a triangle and 16 an edge.
    [[nodiscard]] std::uint64_t gpuBytes() const;

    struct Impl;
    /// For Lamina's own passes; not part of the stable API.
    [[nodiscard]] const Impl& impl() const { return *mImpl; }

private:
    explicit ShadowTopology(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
