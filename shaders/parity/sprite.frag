// Finds the crossings of columns' centre lines with the surface ([TD08] 3.1, 4.1).
//
// One invocation owns one (triangle, column) pair, made by voxelize/slicemap.geom:
//   1. reject columns whose centre the triangle does not own: closed shapes cross each column evenly;
//   2. COUNT: count the crossing in the column. Atomic: other triangles cross the same column.
//      GATHER: take a ticket of the column and store the depth in that layer; resolve.comp sorts.
//      PEEL: layer n is the least depth not in the layers before it, found by MIN blending.
// Depths are fractions of the sprite's depth range. Crossings before it become 0 and beyond it
// LAMINA_PARITY_BEYOND, so that shapes that reach out of the sprite keep their parity.
// What slicemap.geom hands over follows its coverage; sprites are drawn with LAMINA_COVERAGE_SAMPLED.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SOLID
// permute LAMINA_PARITY_PASS = LAMINA_PARITY_PASS_COUNT LAMINA_PARITY_PASS_GATHER LAMINA_PARITY_PASS_PEEL
#include <lamina/shared/parity_block.glsl>
#include <voxelize/draw_block.glsl>

#define LAMINA_STAGE in
#include <voxelize/column_stage.glsl>

layout(binding = LAMINA_PARITY_COUNT_IMAGE, r32ui) uniform uimage2D laminaCounts;

#if LAMINA_PARITY_PASS == LAMINA_PARITY_PASS_GATHER
layout(binding = LAMINA_PARITY_LAYER_IMAGE, r32f) uniform writeonly image2DArray laminaLayers;
#elif LAMINA_PARITY_PASS == LAMINA_PARITY_PASS_PEEL
layout(binding = LAMINA_PARITY_LAYER_IMAGE, r32f) uniform readonly image2DArray laminaLayers;
layout(std140, binding = LAMINA_PARITY_PASS_BLOCK_BINDING) uniform LaminaPeelBlock {
    uvec4 laminaPeel; // the layer of this pass; unused
};
layout(location = 0) out float laminaLayer;
#endif

#if LAMINA_PARITY_PASS != LAMINA_PARITY_PASS_COUNT
// Rounded to single precision, but never onto the centre of a slice before the crossing: the voxels of
// the sprite are then exactly those whose centres lie inside.
float depthOf(LaminaColumnTriangle triangle, dvec2 center) {
    double depth = clamp(laminaPlaneValue(triangle, center), triangle.depthRange.x, triangle.depthRange.y);
    double fraction = (depth - laminaDraw.depthRange.x) * laminaDraw.depthRange.y;
    if (fraction <= 0.0lf)
        return 0.0;
    if (fraction > 1.0lf)
        return LAMINA_PARITY_BEYOND;
    float rounded = float(fraction);
    double slices = laminaDraw.depthRange.w;
    double before = ceil(fraction * slices - 0.5lf) - 0.5lf;
    if (before > 0.0lf && rounded == float(before / slices))
        rounded = uintBitsToFloat(floatBitsToUint(rounded) + 1u);
    return rounded;
}
#endif

#if LAMINA_PARITY_PASS == LAMINA_PARITY_PASS_PEEL
// Does the layer of this pass compete for this depth? Of equal depths, as many as were peeled before
// are left out; which ones does not matter.
bool isLeft(ivec2 column, float depth) {
    int layer = int(laminaPeel.x);
    if (layer == 0)
        return true;
    float previous = imageLoad(laminaLayers, ivec3(column, layer - 1)).r;
    if (depth != previous)
        return depth > previous;
    uint peeled = 1u;
    while (int(peeled) < layer && imageLoad(laminaLayers, ivec3(column, layer - 1 - int(peeled))).r == depth)
        ++peeled;
    return imageAtomicAdd(laminaCounts, column, 1u) >= peeled;
}
#endif

void main() {
    LaminaColumnTriangle triangle = kLaminaNoTriangle;
    triangle.edges = dvec4[3](laminaEdge0, laminaEdge1, laminaEdge2);
    triangle.depthPlane = laminaDepthPlane;
    triangle.depthRange = laminaDepthRange;
    dvec2 center = dvec2(gl_FragCoord.xy);
    if (!laminaOwnsPoint(triangle, center))
        discard;
    ivec2 column = ivec2(gl_FragCoord.xy);
#if LAMINA_PARITY_PASS == LAMINA_PARITY_PASS_COUNT
    imageAtomicAdd(laminaCounts, column, 1u);
#elif LAMINA_PARITY_PASS == LAMINA_PARITY_PASS_GATHER
    int layer = int(imageAtomicAdd(laminaCounts, column, 1u));
    if (layer < imageSize(laminaLayers).z - 1) // the last one is for the blocks
        imageStore(laminaLayers, ivec3(column, layer), vec4(depthOf(triangle, center)));
#else
    laminaLayer = depthOf(triangle, center);
    if (!isLeft(column, laminaLayer))
        discard;
#endif
}
