// Layouts, bindings and numbers of refraction (std140). Valid GLSL and C++.
#ifndef LAMINA_SHARED_REFRACTION_BLOCK
#define LAMINA_SHARED_REFRACTION_BLOCK

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
