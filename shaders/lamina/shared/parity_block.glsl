// Numbers and buffer layouts of depth sprites and the parity test. Valid GLSL and C++.
#ifndef LAMINA_SHARED_PARITY_BLOCK
#define LAMINA_SHARED_PARITY_BLOCK

// Most sprites of a set: the bits of a mask.
#define LAMINA_PARITY_MAX_SPRITES 32

// What a layer holds where a column has no more crossings, and where it has one beyond the far depth.
// Depths that a point can have end at 1.
#define LAMINA_PARITY_NO_LAYER 2.0
#define LAMINA_PARITY_BEYOND 1.5

// Blocks of LAMINA_PARITY_BLOCK x LAMINA_PARITY_BLOCK columns, by which whole boxes are decided. The
// texture's layer after the last crossing holds LAMINA_PARITY_RANGES numbers a block, of block (x,y) in
// texels (2x, 2y) to (2x + 1, 2y + 1): before FIRST and from LAST on all columns are outside, from ENTER
// up to LEAVE inside (none: ENTER >= LEAVE). Sprites of a single column or row have no such numbers.
#define LAMINA_PARITY_BLOCK 8
#define LAMINA_PARITY_RANGES 4
#define LAMINA_PARITY_FIRST 0
#define LAMINA_PARITY_LAST 1
#define LAMINA_PARITY_ENTER 2
#define LAMINA_PARITY_LEAVE 3
// Boxes over more blocks each way are not decided.
#define LAMINA_PARITY_BLOCK_REACH 4

// LaminaSpriteConstants.size.w
#define LAMINA_PARITY_INVERTED 1u

// Answers of laminaParityClassify().
#define LAMINA_PARITY_OUTSIDE 0
#define LAMINA_PARITY_INSIDE 1
#define LAMINA_PARITY_BORDER 2

// Rules that make one answer of the mask of several sprites.
#define LAMINA_PARITY_UNION 0
#define LAMINA_PARITY_INTERSECTION 1
#define LAMINA_PARITY_DIFFERENCE 2

// Up to so many layers are searched one by one, more by bisection.
#define LAMINA_PARITY_LINEAR_LAYERS 8

// Columns with up to so many crossings are sorted by insertion, others by a heap.
#define LAMINA_PARITY_INSERTION_LAYERS 16

// Depths of the four columns around a point are taken to be one surface if they differ by at most so
// many column diagonals.
#define LAMINA_PARITY_STEEPEST 4.0

// LAMINA_PARITY_PASS: what the fragments of a build do.
#define LAMINA_PARITY_PASS_COUNT 0
#define LAMINA_PARITY_PASS_GATHER 1
#define LAMINA_PARITY_PASS_PEEL 2

// Bindings of the build's passes.
#define LAMINA_PARITY_LAYER_IMAGE 0
#define LAMINA_PARITY_COUNT_IMAGE 1
#define LAMINA_PARITY_PASS_BLOCK_BINDING 1
#define LAMINA_PARITY_REPORT_BINDING 0
// A group of the resolve pass is a block.
#define LAMINA_PARITY_RESOLVE_GROUP LAMINA_PARITY_BLOCK

// Bindings of the point kernel, and what it writes.
#define LAMINA_PARITY_POINT_GROUP 64
#define LAMINA_PARITY_POINT_BLOCK_BINDING 0
#define LAMINA_PARITY_POINT_SET_BINDING 1
#define LAMINA_PARITY_POINT_INPUT_BINDING 0
#define LAMINA_PARITY_POINT_OUTPUT_BINDING 1
#define LAMINA_PARITY_ANSWER_BITS 0
#define LAMINA_PARITY_ANSWER_BYTES 1
#define LAMINA_PARITY_ANSWER_CLASSES 2
#define LAMINA_PARITY_ANSWER_MASKS 3

// One sprite of a set.
struct LaminaSpriteConstants {
    // Rows of the affine map from world (x,y,z,1) to (column x, column y, depth in [0,1]).
    vec4 worldToSprite[3];
    // World length of the depth range; world length of a column's diagonal over it; unused.
    vec4 scale;
    // columns x, columns y, layers, LAMINA_PARITY_* flags.
    uvec4 size;
};

// Head of the report that a build leaves.
struct LaminaSpriteReport {
    // Most crossings of a column, made even.
    uint layers;
    // Columns with an odd number of crossings.
    uint oddColumns;
    // Columns with more crossings than layers.
    uint overflowColumns;
    uint unused;
    // Crossings of all columns: low and high word.
    uint crossingsLow;
    uint crossingsHigh;
};

// One dispatch of the point kernel.
struct LaminaPointConstants {
    // First word of point 0 in its binding, words from one point to the next, points of the
    // dispatch, first word of the answers in their binding.
    uvec4 place;
    // LAMINA_PARITY_UNION, ..; sprites of a shape; unused.
    uvec4 rule;
};

#endif
