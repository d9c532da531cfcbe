// Layouts and numbers of point samples and imperfect shadow maps. Valid GLSL and C++.
#ifndef LAMINA_SHARED_IMPERFECT_BLOCK
#define LAMINA_SHARED_IMPERFECT_BLOCK

// Triangles of a block, whose weights are summed by one work group, and of an invocation.
#define LAMINA_SAMPLE_BLOCK_TRIANGLES 1024
#define LAMINA_SAMPLE_GROUP_SIZE 256

// Bindings of the sampling kernels.
#define LAMINA_SAMPLE_CAPTURE_BINDING 0
#define LAMINA_SAMPLE_TRIANGLE_BINDING 1
#define LAMINA_SAMPLE_WEIGHT_BINDING 2
#define LAMINA_SAMPLE_BLOCK_BINDING 3
#define LAMINA_SAMPLE_POINT_BINDING 4
#define LAMINA_SAMPLE_BINDING_COUNT 5
#define LAMINA_SAMPLE_UNIFORM_BINDING 0

// Bindings of the splat and hole filling kernels.
#define LAMINA_SPLAT_TRIANGLE_BINDING 0
#define LAMINA_SPLAT_POINT_BINDING 1
#define LAMINA_SPLAT_MAP_BINDING 2
#define LAMINA_SPLAT_BINDING_COUNT 3
#define LAMINA_SPLAT_UNIFORM_BINDING 0
#define LAMINA_SPLAT_IMAGE 0

// Most texels that a point sample covers from its middle, in each direction.
#define LAMINA_SPLAT_MOST_TEXELS 12

// Enlargement of disks beyond the area that they stand for: disks of just that area, at random places, would
// leave a third of the surface bare.
#define LAMINA_SPLAT_OVERLAP 2.0
// The same for disks that reach beyond their triangles, which may have no neighbours to cover: leaves.
#define LAMINA_SPLAT_OVERLAP_SMALL 1.4

// A texel without a surface: the bits of the largest float.
#define LAMINA_SPLAT_EMPTY 0x7f7fffffu

// LaminaSampleConstants: one dispatch of a sampling kernel.
struct LaminaSampleConstants {
    // From the captured positions to world space.
    mat4 toWorld;
    // Middle of the light, distance from it below which triangles are not sampled more densely (0: triangles
    // are sampled by area alone).
    vec4 light;
    // Captured triangles, first block, blocks in all, points.
    uvec4 counts;
};

// A point of a surface, and the part of the surface that it stands for.
struct LaminaPointSample {
    // World position; radius of a disk of that part's area.
    vec4 position;
    // Unit normal; area of the sample's triangle.
    vec4 normal;
    // Index of the triangle; unused.
    uvec4 triangle;
};

// Where a virtual light's map looks.
struct LaminaImperfectMap {
    // Rows of the map from world space (x, y, z, 1) to (s, t, middle) around the light. Directional lights:
    // s and t from -1 to 1 over the map, depth from 0 to 1.
    vec4 rows[3];
};

// One dispatch of a splat or hole filling kernel.
struct LaminaSplatConstants {
    // Texels a side of a map, points in all, points a map, first layer's map.
    uvec4 counts;
    // Level that is written, its size, its first texel in x and y.
    uvec4 level;
    // The other level's size, its first texel in x and y, unused.
    uvec4 other;
    // Enlargement of disks, as a map has a share of the points; unused.
    vec4 numbers;
};

#endif
