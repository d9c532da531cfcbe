// Near and far depth of every column in one pass: MIN blending gathers (near, -far) ([ED06] 2.3).
//
// One invocation owns one (triangle, column) pair:
//   1. the depths that the triangle gives the column by its coverage, cut to the grid's depths;
//   2. write them rounded outwards to floats, so that the column's slices hold all of them.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SOLID
// permute LAMINA_SPLIT = 0 1
#include <voxelize/slicemap_fragment.glsl>

layout(location = 0) out vec2 laminaRange;

// The largest float up to `value`, or the one below it.
float floatBelow(double value) {
    float nearest = float(value);
    // One step down, of a size that is never denormal: those may be flushed to zero.
    return double(nearest) <= value ? nearest : nearest - max(abs(nearest) * 1.1920929e-7, 1.0e-37);
}

void main() {
    double near = laminaDraw.depthRange.x;
    dvec2 depths;
    if (!laminaDepthsBetween(near, near + 1.0lf / laminaDraw.depthRange.y, depths))
        discard;
    laminaRange = vec2(floatBelow(depths.x), floatBelow(-depths.y));
}
