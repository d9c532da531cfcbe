// Sets the bits of one column for one triangle; logic op OR gathers them ([ED06] 2.2), or XOR where the
// inside is wanted (Eisemann and Decoret 2008).
//
// One invocation owns one (triangle, column) pair of one pass of 128 slices:
//   1. reject columns that the triangle gives no depths (laminaDepthsInColumn);
//   2. Sampled: the slice of the triangle's depth at the centre;
//      Filled, Conservative: the slices between the least and the greatest depth of the part of the
//      triangle in the column's square;
//      Solid: all slices whose centre lies before the depth at the centre, to be toggled. What remains
//      set has an odd number of crossings beyond it;
//   3. write their bits of this pass.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SOLID
#include <voxelize/draw_block.glsl>
#include <voxelize/column_depths.glsl>

layout(std140, binding = LAMINA_PASS_GRID_BLOCK_BINDING) uniform LaminaPassGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaPassGrid;

#include <lamina/slice_distribution.glsl>

#define LAMINA_STAGE in
#include <voxelize/column_stage.glsl>

LaminaColumnTriangle receivedTriangle() {
    LaminaColumnTriangle triangle = kLaminaNoTriangle;
    triangle.edges = dvec4[3](laminaEdge0, laminaEdge1, laminaEdge2);
    triangle.depthPlane = laminaDepthPlane;
    triangle.depthRange = laminaDepthRange;
#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED || LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
    triangle.edgeValues = dvec2[3](laminaEdgeValues0, laminaEdgeValues1, laminaEdgeValues2);
    triangle.isEdgeOn = laminaIsEdgeOn != 0;
#endif
    return triangle;
}

layout(location = 0) out uvec4 laminaBits;

#if LAMINA_COVERAGE == LAMINA_COVERAGE_SOLID
// A bit for each column: odd number of crossings. Atomic: 32 columns share a word.
layout(r32ui, binding = LAMINA_COLUMN_PARITY_IMAGE) uniform uimage2D laminaColumnParity;

void laminaToggleColumn(ivec2 column) {
    imageAtomicXor(laminaColumnParity, ivec2(column.x >> 5, column.y), 1u << uint(column.x & 31));
}
#endif

// Bits [first, last] of the pass's 128; first and last may lie outside.
uvec4 bitRange(int first, int last) {
    ivec4 low = clamp(ivec4(first) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    ivec4 high = clamp(ivec4(last + 1) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    uvec4 belowLow = mix((uvec4(1u) << uvec4(low & 31)) - 1u, uvec4(0xffffffffu), equal(low, ivec4(32)));
    uvec4 belowHigh = mix((uvec4(1u) << uvec4(high & 31)) - 1u, uvec4(0xffffffffu), equal(high, ivec4(32)));
    return belowHigh & ~belowLow;
}

void main() {
    dvec2 depths;
    if (!laminaDepthsInColumn(receivedTriangle(), dvec2(gl_FragCoord.xy), depths))
        discard;

    int firstSlice = int(laminaDraw.pass.x);
    laminaBits = uvec4(0u);
#if LAMINA_COVERAGE == LAMINA_COVERAGE_SAMPLED
    int slice = laminaSliceAt(depths.x, laminaDraw);
    if (slice >= 0)
        laminaBits = bitRange(slice - firstSlice, slice - firstSlice);
#elif LAMINA_COVERAGE == LAMINA_COVERAGE_SOLID
    laminaBits = bitRange(-firstSlice, laminaLastCenterBefore(depths.x, laminaDraw) - firstSlice);
    if (firstSlice == 0)
        laminaToggleColumn(ivec2(gl_FragCoord.xy));
#else
    double near = laminaDraw.depthRange.x;
    double far = near + 1.0lf / laminaDraw.depthRange.y;
    double rounding = LAMINA_DEPTH_SNAP / laminaDraw.depthRange.y;
    if (depths.y >= near - rounding && depths.x <= far + rounding) {
        depths = clamp(depths, dvec2(near), dvec2(far));
        laminaBits = bitRange(laminaSliceAt(depths.x, laminaDraw) - firstSlice, laminaSliceAt(depths.y, laminaDraw) - firstSlice);
    }
#endif
}
