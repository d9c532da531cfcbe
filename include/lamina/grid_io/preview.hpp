#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/grid/attribute_grid.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/grid_io/image.hpp>
#include <lamina/grid_io/progress.hpp>

#include <glm/vec3.hpp>

#include <cstdint>

namespace lamina {

/// How renderPreview() looks at a grid. The defaults make a picture fit for a README.
/// Colours are sRGB in [0,1], as a colour picker shows them.
struct PreviewDesc {
    std::uint32_t width = 1024;  ///< Pixels, 1 to 16384.
    std::uint32_t height = 1024; ///< Pixels, 1 to 16384.
    /// From the camera towards the grid, world space, any length but 0.
    glm::dvec3 viewDirection{-0.62, -0.42, -0.86};
    /// Where up is in the picture, and the side from which the sky shines; any length but 0.
    /// Along the view direction: another axis serves for the picture.
    glm::dvec3 up{0.0, 1.0, 0.0};
    double fieldOfView = 0.45; ///< Vertical, radians, in (0, pi).
    /// Empty border around the grid's box, a share of the picture's width and height, in [0, 0.9].
    double margin = 0.06;
    std::uint32_t samplesPerPixel =
        16;                    ///< Primary rays, 1 to 4096; time and smoothness grow with it.
    std::uint32_t threads = 0; ///< Including the caller's; 0: one a processor.

    /// Colours of the set voxels, in their place; borrowed. None, or a voxel without: by height.
    const AttributeGrid* attributes = nullptr;
    glm::vec3 lowColor{0.12f, 0.31f, 0.55f};  ///< Voxels at the grid's foot.
    glm::vec3 highColor{0.98f, 0.70f, 0.47f}; ///< Voxels at its top.
    glm::vec3 backgroundTop{0.87f, 0.90f, 0.94f};
    glm::vec3 backgroundBottom{0.97f, 0.97f, 0.96f};
    bool transparentBackground =
        false;          ///< Nothing but voxels and their shadow, for any page colour.
    bool ground = true; ///< A shadow on the ground under the lowest set voxel.
    bool edges = true;  ///< Bevels and joints where a voxel is a few pixels wide.
};

/// A shaded, anti-aliased picture of the voxels themselves: blocks in perspective under sun and
/// sky, the grid's box just inside the picture. An empty grid shows the background alone.
///
/// grid: from GridTransform::box() with linear slices, any axis; voxels need not be cubes.
///
/// progress: called on the caller's thread. Equal arguments give equal pictures, whatever the
/// number of threads.
/// Memory: 20 bytes a pixel, and 512 bytes for each 16 x 16 x 16 voxels of which any is set.
/// Cost: about 0.4 microseconds of processor time a sample, whatever the size of the grid.
/// Errors: InvalidArgument (a value out of its range, attributes of another number of voxels),
/// Unsupported (another grid), OutOfMemory, Cancelled.
/// Threads: may be called from several; starts `threads` - 1 of its own and waits for them.
[[nodiscard]] LAMINA_API Result<Image> renderPreview(const BitGrid& grid,
                                                     const PreviewDesc& desc = {},
                                                     const ProgressCallback& progress = {});

} // namespace lamina
