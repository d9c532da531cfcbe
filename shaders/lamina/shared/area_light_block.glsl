// Layouts and numbers of lights in participating media. Valid GLSL and C++.
#ifndef LAMINA_SHARED_AREA_LIGHT_BLOCK
#define LAMINA_SHARED_AREA_LIGHT_BLOCK

// LaminaAreaLightConstants.counts.y
#define LAMINA_AREA_LIGHT_INTERPOLATE 1u
#define LAMINA_AREA_LIGHT_FACTORED 2u

// Phi samples that share a weight in the weighted airlight; divides 32.
#define LAMINA_AIRLIGHT_BITS_PER_WEIGHT 8

// Phi samples before a surface that its own shadow may reach.
#define LAMINA_AIRLIGHT_OWN_SHADOW 3

// Half the nodes of the quadrature of unshadowed airlight.
#define LAMINA_AIRLIGHT_NODE_PAIRS 6

// Exponent after which what is left of a ray adds nothing.
#define LAMINA_AIRLIGHT_DEPTH 10.0

// Bindings of the gather and composite passes.
#define LAMINA_AREA_LIGHT_PASS_VIEW_BINDING 0
#define LAMINA_AREA_LIGHT_PASS_GATHER_BINDING 1
#define LAMINA_AREA_LIGHT_PASS_SPACE_BINDING 0
#define LAMINA_AREA_LIGHT_PASS_LIGHT_BINDING 1
#define LAMINA_AREA_LIGHT_PASS_WORD_UNIT 0
#define LAMINA_AREA_LIGHT_PASS_DEPTH_UNIT 1
#define LAMINA_AREA_LIGHT_PASS_NORMAL_UNIT 2
#define LAMINA_AREA_LIGHT_PASS_ALBEDO_UNIT 3
#define LAMINA_AREA_LIGHT_PASS_COLOR_UNIT 4
#define LAMINA_AREA_LIGHT_PASS_AIRLIGHT_UNIT 5
#define LAMINA_AREA_LIGHT_PASS_SURFACE_UNIT 6
#define LAMINA_AREA_LIGHT_PASS_UNITS 7
#define LAMINA_AREA_LIGHT_PASS_AIRLIGHT_IMAGE 0
#define LAMINA_AREA_LIGHT_PASS_SURFACE_IMAGE 1

// Pixels of a work group of the gather kernel, in x and y.
#define LAMINA_AREA_LIGHT_GATHER_SIZE 8

// LAMINA_AREA_LIGHT_FILTER: how sums become pixels.
#define LAMINA_AREA_LIGHT_FILTER_NONE 0
#define LAMINA_AREA_LIGHT_FILTER_INTERLEAVED 1
#define LAMINA_AREA_LIGHT_FILTER_UPSAMPLE 2

// Head of the buffer of virtual lights.
struct LaminaAreaLightConstants {
    // Scattering coefficient by colour, extinction coefficient; per world unit.
    vec4 medium;
    // Henyey-Greenstein's g; unused.
    vec4 phase;
    // Virtual lights, LAMINA_AREA_LIGHT_* flags, unused, unused.
    uvec4 counts;
};

// One virtual point light.
struct LaminaVirtualLight {
    // World position, 1; or unit vector towards the light, 0.
    vec4 position;
    // Unit normal of a Lambertian emitter; radius of the part of the light that it stands for.
    vec4 normal;
    // Radiant intensity along the normal (or in all directions), or irradiance of a directional light;
    // 1 if the emitter is Lambertian, 0 if it shines alike in all directions.
    vec4 intensity;
};

// One gather dispatch, and the composite after it.
struct LaminaGatherConstants {
    // First virtual light, lights, index of the first of them in the bound grid, subsets of lights (1 or 9).
    uvec4 lights;
    // Pixels of the sums in x and y, pixels of the view per pixel of the sums, LAMINA_AREA_LIGHT_* inputs.
    uvec4 pixels;
    // Distance that stands for that of the sky, relative difference of distances that filters keep apart,
    // Phong exponent, Phong strength.
    vec4 numbers;
};

// LaminaGatherConstants.pixels.w
#define LAMINA_AREA_LIGHT_HAS_NORMALS 1u
#define LAMINA_AREA_LIGHT_HAS_ALBEDO 2u
#define LAMINA_AREA_LIGHT_HAS_COLOR 4u
#define LAMINA_AREA_LIGHT_UNSIGNED_NORMALS 8u
#define LAMINA_AREA_LIGHT_ADDS 16u

#endif
