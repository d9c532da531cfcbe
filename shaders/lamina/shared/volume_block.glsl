// Layouts and numbers of volumes (VolumeGrid). Valid GLSL and C++.
#ifndef LAMINA_SHARED_VOLUME_BLOCK
#define LAMINA_SHARED_VOLUME_BLOCK

#include <lamina/shared/grid_block.glsl>

// LaminaVolumeConstants.payload.x: what a volume holds. The counts stand in one of two textures.
#define LAMINA_VOLUME_COUNT_R32UI 1
#define LAMINA_VOLUME_COUNT_R8 2
#define LAMINA_VOLUME_ABSORPTION 4
#define LAMINA_VOLUME_NORMAL 8
#define LAMINA_VOLUME_COLOR 16
#define LAMINA_VOLUME_OPTICS 32
// LaminaVolumeConstants.payload.y: which of these are means in 8 bits; the others are sums.

// Texture units of a volume, after LAMINA_VOLUME_TEXTURE_UNIT.
#define LAMINA_VOLUME_UNIT_COUNT_R32UI 0
#define LAMINA_VOLUME_UNIT_COUNT_R8 1
#define LAMINA_VOLUME_UNIT_ABSORPTION 2
#define LAMINA_VOLUME_UNIT_NORMAL 3
#define LAMINA_VOLUME_UNIT_COLOR 4
#define LAMINA_VOLUME_UNIT_OPTICS 5
#define LAMINA_VOLUME_UNITS 6

// Refractive indices of RGBA8 optics lie in [1, 1 + this].
#define LAMINA_VOLUME_INDEX_RANGE 3.0

// Mean normals shorter than this are none: the surfaces' normals cancel out up to rounding.
#define LAMINA_VOLUME_CANCELLED_NORMAL 0.02

// Voxelization: bindings and the work of one geometry shader invocation.
#define LAMINA_VOLUME_MATERIAL_BLOCK_BINDING 2
#define LAMINA_VOLUME_COUNT_IMAGE 0
#define LAMINA_VOLUME_TALL_BLOCK_BINDING 0
#define LAMINA_VOLUME_LAYERS_PER_INVOCATION 7
#define LAMINA_VOLUME_INVOCATIONS_OF_LATER_PASSES 32

// LAMINA_VOLUME_PASS: the first layers of every triangle, these and a list of the triangles that have
// more, further layers.
#define LAMINA_VOLUME_PASS_FIRST 0
#define LAMINA_VOLUME_PASS_FIRST_LISTING 1
#define LAMINA_VOLUME_PASS_LATER 2
#define LAMINA_MAX_MATERIALS 512

// LaminaMaterialConstants.optics.w
#define LAMINA_FACING_ANY 0.0
#define LAMINA_FACING_FRONT 1.0
#define LAMINA_FACING_BACK 2.0

struct LaminaVolumeConstants {
    LaminaGridConstants grid;
    // LAMINA_VOLUME_* present, LAMINA_VOLUME_* in 8 bits, unused, unused.
    uvec4 payload;
};

// One draw of a pass, in double precision.
struct LaminaVolumeDrawConstants {
    // Rows of the map from the source's local space to (column x * w, column y * w, depth).
    dvec4 localToColumn[3];
    // near depth, 1 / (far - near), near depth * LAMINA_EYE_CUT, far depth.
    dvec4 depthRange;
    // Rows of the map of normals from the source's local space to the world; in w -1 if it mirrors.
    vec4 normalToWorld[3];
    // columns x, columns y, slices, LAMINA_GRID_* flags.
    uvec4 size;
    // First layer of each triangle that this pass draws, counted from the triangle's own first
    // layer; material id; 1 if a front face turns clockwise in column space; LAMINA_VOLUME_* asked.
    uvec4 pass;
    // Pixels by which polygons are dilated before rasterization; slab overlap in slices; greatest
    // material id; unused.
    vec4 settings;
};

// glDrawElementsIndirect's arguments, and five words into the buffer the indices that it draws: the
// triangles with more layers than the first pass draws.
struct LaminaTallTriangles {
    uint count;
    uint instanceCount;
    uint firstIndex;
    int baseVertex;
    uint baseInstance;
};

struct LaminaMaterialConstants {
    vec4 color;
    // absorption, refractive index, transmission, LAMINA_FACING_*.
    vec4 optics;
};

#endif
