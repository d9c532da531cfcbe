// Numbers and buffer layouts of SolidRule::Voted and SolidRule::FloodFill. Valid GLSL and C++.
#ifndef LAMINA_SHARED_SOLID_BLOCK
#define LAMINA_SHARED_SOLID_BLOCK

#include <lamina/shared/overlap_block.glsl>

// Lines through each voxel centre: along the axes and the diagonals of the grid. Each votes twice, once
// for either end. Voxels on which the axes agree are settled; on the others, which are contested, the
// diagonals vote too. With 14 votes a majority is 8 or more: the top bit of a count of four bits.
#define LAMINA_SOLID_AXIS_COUNT 3
#define LAMINA_SOLID_LINE_COUNT 7
// A contested voxel is doubtful if the smaller side has at least so many votes.
#define LAMINA_SOLID_DOUBTFUL_VOTES 5

// Bindings: uniform buffers beside LAMINA_OVERLAP_BLOCK_BINDING, storage buffers beside
// LAMINA_OVERLAP_WORDS_BINDING. Votes take three storage bindings.
#define LAMINA_SOLID_LINE_BINDING 1
#define LAMINA_SOLID_PART_BINDING 2
#define LAMINA_SOLID_UNIFORM_COUNT 3
#define LAMINA_SOLID_VOTES_BINDING 1
#define LAMINA_SOLID_CELLS_BINDING 5
#define LAMINA_SOLID_TALLY_BINDING 4
#define LAMINA_SOLID_CONTESTED_BINDING 6
#define LAMINA_SOLID_TOUCHED_BINDING 6
#define LAMINA_SOLID_TILES_BINDING 7
#define LAMINA_FLOOD_OUTSIDE_BINDING 1
#define LAMINA_FLOOD_CARRY_BINDING 2
#define LAMINA_SOLID_BINDING_COUNT 8

// LaminaSolidLine.rows.z: which axes of the grid are (P, Q, S).
#define LAMINA_SOLID_ALONG_X 0
#define LAMINA_SOLID_ALONG_Y 1
#define LAMINA_SOLID_ALONG_Z 2

// The lines of one direction. Line (p, q) meets at step s, counted along axis S, the voxel with
// coordinates p + slope.x * s along axis P and q + slope.y * s along axis Q. (P, Q, S) is (y, z, x),
// (x, z, y) or (y, x, z).
struct LaminaSolidLine {
    // Voxels along P, Q, S, and unused.
    ivec4 grid;
    // Along P and Q from one step to the next, -1 to 1; multiples of period.x and period.y greater
    // than any step.
    ivec4 slope;
    // Cells: rows, bits along a row's words, slots of a row, words of a slot.
    ivec4 period;
    // First row that the cells' binding holds, number of rows, LAMINA_SOLID_ALONG_*, words of a run of
    // touched bits (solid_cells.glsl; of a diagonal, which keeps none, 0).
    ivec4 rows;
};

// The part of the grid's words that a storage binding holds.
struct LaminaSolidPart {
    // First voxel; w: texels between the binding's start and the part's first texel.
    ivec4 low;
    // Last voxel, inclusive; w: number of the part.
    ivec4 high;
    // Of the whole grid: columns x, columns y, slices; w: tiles of the parts before.
    ivec4 size;
};

// Words of the tally: two numbers, each its lower and its higher 32 bits; whether a round of a flood
// found anything; whether any voxel is contested; whether the mesh is closed; whether its parity is its
// solid; from LAMINA_TALLY_SUMS on the sums of crossing_check.glsl, from LAMINA_TALLY_DISPATCHES on
// indirect dispatches, four words each.
#define LAMINA_TALLY_DOUBTFUL 0
#define LAMINA_TALLY_ENCLOSED 2
#define LAMINA_TALLY_CHANGED 4
#define LAMINA_TALLY_CONTESTED 5
#define LAMINA_TALLY_CLOSED 6
#define LAMINA_TALLY_CLEAN 7
#define LAMINA_TALLY_SUMS 8
#define LAMINA_TALLY_DISPATCHES 264

// Sums, of two words each, in so many slots, lest all invocations add to the same words. A slot: of the
// edges, of the crossings, of the changes along filled columns, unused.
#define LAMINA_SUM_SLOTS 32
#define LAMINA_SUM_STRIDE 8
#define LAMINA_SUM_EDGES 0
#define LAMINA_SUM_CROSSINGS 2
#define LAMINA_SUM_CHANGES 4

// Rounds of a flood, at most. A round finds what is one more turn of a passage away from the outside.
#define LAMINA_FLOOD_ROUNDS 256

#endif
