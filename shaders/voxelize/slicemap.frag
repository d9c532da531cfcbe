// Sets the bits of one column for one triangle; logic op OR gathers them ([ED06] 2.2).
//
// One invocation owns one (triangle, column) pair of one pass of 128 slices:
//   1. reject columns whose centre the triangle does not own;
//   2. Sampled: the slice of the triangle's depth at the centre;
//      Filled: the slices between the least and the greatest depth of the part of the triangle in
//      the column's square, found as the extremes of an affine function over a convex polygon;
//   3. write their bits of this pass.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED
#include <voxelize/draw_block.glsl>
#include <voxelize/column_depths.glsl>

layout(std140, binding = LAMINA_PASS_GRID_BLOCK_BINDING) uniform LaminaPassGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaPassGrid;

#include <lamina/slice_distribution.glsl>

layout(location = 0) flat in dvec4 laminaEdge0;
layout(location = 2) flat in dvec4 laminaEdge1;
layout(location = 4) flat in dvec4 laminaEdge2;
layout(location = 6) flat in dvec3 laminaDepthPlane;
layout(location = 8) flat in dvec2 laminaDepthRange;

layout(location = 0) out uvec4 laminaBits;

// Bits [first, last] of the pass's 128; first and last may lie outside.
uvec4 bitRange(int first, int last) {
    ivec4 low = clamp(ivec4(first) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    ivec4 high = clamp(ivec4(last + 1) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    uvec4 belowLow = mix((uvec4(1u) << uvec4(low & 31)) - 1u, uvec4(0xffffffffu), equal(low, ivec4(32)));
    uvec4 belowHigh = mix((uvec4(1u) << uvec4(high & 31)) - 1u, uvec4(0xffffffffu), equal(high, ivec4(32)));
    return belowHigh & ~belowLow;
}

void main() {
    LaminaColumnTriangle triangle =
        LaminaColumnTriangle(dvec4[3](laminaEdge0, laminaEdge1, laminaEdge2), laminaDepthPlane, laminaDepthRange);
    dvec2 depths;
    if (!laminaDepthsInColumn(triangle, dvec2(gl_FragCoord.xy), depths))
        discard;

    int firstSlice = int(laminaDraw.pass.x);
    laminaBits = uvec4(0u);
#if LAMINA_COVERAGE == LAMINA_COVERAGE_SAMPLED
    int slice = laminaSliceAt(depths.x, laminaDraw);
    if (slice >= 0)
        laminaBits = bitRange(slice - firstSlice, slice - firstSlice);
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
