// What the fragments of slicemap passes share: the triangle that the geometry stage hands over, and the
// depths that the grid can hold of it.
#include <voxelize/draw_block.glsl>
#include <voxelize/column_depths.glsl>

#define LAMINA_STAGE in
#include <voxelize/column_stage.glsl>

LaminaColumnTriangle laminaReceivedTriangle() {
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

// The part of the triangle's depths in this column that lies in [near, far]; false if none. Depths within
// rounding of near and far count as on them.
bool laminaDepthsBetween(double near, double far, out dvec2 depths) {
    if (!laminaDepthsInColumn(laminaReceivedTriangle(), dvec2(gl_FragCoord.xy), depths))
        return false;
    double rounding = LAMINA_DEPTH_SNAP / laminaDraw.depthRange.y;
    if (!(depths.y >= near - rounding && depths.x <= far + rounding))
        return false;
    depths = clamp(depths, dvec2(near), dvec2(far));
    return true;
}
