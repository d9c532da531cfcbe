// Numbers and buffer layouts of the overlap backend. Valid GLSL and C++.
#ifndef LAMINA_SHARED_OVERLAP_BLOCK
#define LAMINA_SHARED_OVERLAP_BLOCK

#include <lamina/shared/constants.glsl>

// Invocations of a work group, and columns of a block: 8 x 8.
#define LAMINA_OVERLAP_GROUP_SIZE 64

// Triangles of one dispatch; an invocation each.
#define LAMINA_OVERLAP_CHUNK_TRIANGLES 262144

// Triangles that span at most so many voxels along each axis, and whose box so many columns, are
// done by one invocation; the others by work groups, each taking blocks of columns, and enqueued by
// their number of blocks: class c has up to 64 * 16^c blocks (the last class any number) and 16^c
// work groups a triangle. So every group has work for it, and none loops for long.
#define LAMINA_OVERLAP_SMALL_VOXELS 32
#define LAMINA_OVERLAP_SMALL_COLUMNS 256
#define LAMINA_OVERLAP_CLASS_COUNT 4
#define LAMINA_OVERLAP_CLASS_BLOCKS 64
#define LAMINA_OVERLAP_CLASS_FACTOR 16

// The limit of GL_MAX_COMPUTE_WORK_GROUP_COUNT that every device has.
#define LAMINA_OVERLAP_MAX_GROUPS 65535

// Voxels are taken this much larger on every side, to absorb the rounding of float voxel coordinates
// relative to a small triangle. No voxel is missed; one that is further than 1e-4 from the triangle
// is never set.
#define LAMINA_OVERLAP_ALLOWANCE 4.0e-5

// LaminaOverlapConstants.source.z
#define LAMINA_INDEX_NONE 0u
#define LAMINA_INDEX_UINT16 1u
#define LAMINA_INDEX_UINT32 2u

// LaminaOverlapConstants.colors.z
#define LAMINA_COLORS_NONE 0u
#define LAMINA_COLORS_FLOAT 1u
#define LAMINA_COLORS_UNORM8 2u

// What crossings of triangles with columns are noted as: toggles for SolidRule::Parity; signed counts for
// SolidRule::Voted; toggles, and sums that tell whether they are all that SolidRule::Voted needs.
#define LAMINA_CROSSINGS_PARITY 0
#define LAMINA_CROSSINGS_SIGNED 1
#define LAMINA_CROSSINGS_CHECKED 2

// Bindings of the overlap programs.
#define LAMINA_OVERLAP_BLOCK_BINDING 0
#define LAMINA_OVERLAP_WORDS_BINDING 0
#define LAMINA_OVERLAP_VERTEX_BINDING 1
#define LAMINA_OVERLAP_INDEX_BINDING 2
#define LAMINA_OVERLAP_QUEUE_BINDING 3
#define LAMINA_OVERLAP_COLUMNS_BINDING 4
#define LAMINA_OVERLAP_BINDING_COUNT 5
// Those of the attribute programs, which need neither words nor columns.
#define LAMINA_OVERLAP_NORMALS_BINDING 4
#define LAMINA_OVERLAP_COLORS_BINDING 5

// One dispatch: a chunk of a source's triangles, into the part of the grid that one storage binding
// holds.
struct LaminaOverlapConstants {
    // Rows of the map from the source's local space to grid coordinates (columns x, y, slices).
    dvec4 localToGrid[3];
    // First voxel of the part; w: texels between the binding's start and the part's first texel.
    ivec4 low;
    // Last voxel of the part, inclusive; unused.
    ivec4 high;
    // columns x, rows of a layer in the binding, layers of the part, unused.
    uvec4 grid;
    // Vertices: first word in the binding, words from one to the next, count, unused.
    uvec4 vertices;
    // triangles of the chunk, first index in the binding, LAMINA_INDEX_*, unused.
    uvec4 source;
    // Of the attribute programs. Normals: first word in the binding, words from one to the next (0: the
    // vertices have none), unused, unused.
    uvec4 normals;
    // Colours: first word, words from one to the next, LAMINA_COLORS_*, unused.
    uvec4 colors;
    // Material ids: first word in the colours' binding, words from one to the next; or the id of all, 0.
    uvec4 materials;
    // Rows of the map of normals from the source's local space to the world.
    vec4 normalToWorld[3];
    // std140 ends a struct at a multiple of its dvec4's alignment.
    uvec4 unused;
};

// Head of a class in the queue: an indirect dispatch and the number of its triangles.
struct LaminaOverlapClass {
    uint groupsX;
    uint groupsY;
    uint groupsZ;
    uint count;
};

#endif
