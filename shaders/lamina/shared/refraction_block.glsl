// Layouts, bindings and numbers of refraction (std140). Valid GLSL and C++.
#ifndef LAMINA_SHARED_REFRACTION_BLOCK
#define LAMINA_SHARED_REFRACTION_BLOCK

#include <lamina/shared/view_block.glsl>

// LAMINA_INTEGRAL_METHOD
#define LAMINA_INTEGRAL_ARITHMETIC 0
#define LAMINA_INTEGRAL_TABLE 1

// The evaluation table ([ED06] 3.3): a texel for each pair of 8-bit masks, front in x, back in y.
#define LAMINA_INTEGRAL_TABLE_SIZE 256
// Added to a count of the table whose pair leaves the ray inside.
#define LAMINA_INTEGRAL_INSIDE 128

// Bindings of the pass that measures thickness: the two grids, front faces first.
#define LAMINA_THICKNESS_GRID_UNIT 0
#define LAMINA_THICKNESS_RANGE_UNIT 2
#define LAMINA_THICKNESS_TABLE_UNIT 4
#define LAMINA_THICKNESS_UNITS 5
#define LAMINA_THICKNESS_GRID_BINDING 0
#define LAMINA_THICKNESS_BLOCK_BINDING 2
#define LAMINA_THICKNESS_BLOCKS 3
#define LAMINA_THICKNESS_REPORT_BINDING 0

// LAMINA_REFRACTION_MODEL
#define LAMINA_REFRACTION_VOLUME_INTEGRAL 0
#define LAMINA_REFRACTION_TWO_SURFACES 1
#define LAMINA_REFRACTION_MANY_SURFACES 2

// After LAMINA_REFRACTION_TEXTURE_UNIT.
#define LAMINA_REFRACTION_ENVIRONMENT_UNIT 0
#define LAMINA_REFRACTION_BEHIND_UNIT 1
#define LAMINA_REFRACTION_BEHIND_DEPTH_UNIT 2
#define LAMINA_REFRACTION_THICKNESS_UNIT 3
#define LAMINA_REFRACTION_PLANE_UNIT 3
#define LAMINA_REFRACTION_OPTICS_UNIT 4
#define LAMINA_REFRACTION_BRICK_UNIT 5
#define LAMINA_REFRACTION_UNITS 6

// Bindings of apply(): depths, normals and object numbers, then what the include reads.
#define LAMINA_REFRACTION_APPLY_DEPTH_UNIT 0
#define LAMINA_REFRACTION_APPLY_NORMAL_UNIT 1
#define LAMINA_REFRACTION_APPLY_OBJECT_UNIT 2
#define LAMINA_REFRACTION_APPLY_TEXTURE_UNIT 3
#define LAMINA_REFRACTION_APPLY_BLOCK_BINDING 0
#define LAMINA_REFRACTION_APPLY_REPORT_BINDING 0

// LaminaRefractionConstants.modes.x
#define LAMINA_REFRACTION_POWER 1u
#define LAMINA_REFRACTION_BEHIND 2u
#define LAMINA_REFRACTION_BEHIND_DEPTH 4u
#define LAMINA_REFRACTION_OPTICS 8u
#define LAMINA_REFRACTION_UNSIGNED_NORMALS 16u
#define LAMINA_REFRACTION_OBJECTS 32u

// Voxels a side of the bricks that tell empty space.
#define LAMINA_REFRACTION_BRICK 4
// Steps of a marching ray, in voxels along its dominant axis: a surface at a voxel's face is seen for half a
// voxel on one side.
#define LAMINA_REFRACTION_STEP 0.45
// Of the weights of a look-up: less is no surface.
#define LAMINA_REFRACTION_LEAST_WEIGHT 0.01
// Voxels before a surface's plane, or along the ray, after which a ray that has met it may meet it again: what
// the planes of its voxels differ by, and how far look-ups see it.
#define LAMINA_REFRACTION_CLEAR_DEPTH 0.1
#define LAMINA_REFRACTION_CLEAR_LENGTH 3.0
// Media that a ray can be in at a time, one within the other.
#define LAMINA_REFRACTION_MAX_MEDIA 6
// Steps of a ray: a bound, since a shader invocation may run 65535 loop iterations.
#define LAMINA_REFRACTION_MAX_STEPS 16384

// Blur of level 0 of an environment, in its texels: standard deviation of a look-up. Doubles by level.
#define LAMINA_ENVIRONMENT_SIGMA 0.7

struct LaminaRefractionConstants {
    LaminaViewConstants view;
    // Refractive index; scale of Fresnel reflection; length after which the direction is fully bent (0:
    // at once); distance from the exit to what lies behind.
    vec4 surface;
    // Absorption by red, green and blue per world unit (Beer-Lambert), or the colour of the opaque body
    // (power); exponent.
    vec4 body;
    // Length at which a body by the power law is opaque; blur of the surface, radians; blur per world unit
    // inside; cosine of the angle below which normals are the same surface's.
    vec4 blur;
    // Low corner of the volume, voxels per world unit.
    vec4 volume;
    // Refractive index, transmittance of red, green, blue per world unit, if all surfaces share them.
    vec4 optics;
    // LAMINA_REFRACTION_* flags, greatest level of the environment, texels a side of its level 0, greatest
    // number of events.
    uvec4 modes;
    // Voxels a side of the volume, number of the object, greatest level of what lies behind; unused.
    uvec4 sizes;
};

// What the pass that shades a G-buffer counts.
struct LaminaRefractionCounts {
    uint openPixels;
};

struct LaminaThicknessConstants {
    // Change of the position per depth along a pixel's ray: x, y = pixel * slope.xy + slope.zw, z = 1;
    // all 0 in an orthographic view.
    vec4 slope;
};

// What the pass that measures thickness counts.
struct LaminaThicknessCounts {
    uint openColumns;
    uint ambiguousColumns;
};

#endif
