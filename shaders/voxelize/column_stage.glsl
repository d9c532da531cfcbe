// What slicemap.geom hands to fragment stages of a triangle. The includer defines LAMINA_STAGE as out or in.
#include <voxelize/column_triangle.glsl>

layout(location = 0) flat LAMINA_STAGE dvec4 laminaEdge0;
layout(location = 2) flat LAMINA_STAGE dvec4 laminaEdge1;
layout(location = 4) flat LAMINA_STAGE dvec4 laminaEdge2;
layout(location = 6) flat LAMINA_STAGE dvec3 laminaDepthPlane;
layout(location = 8) flat LAMINA_STAGE dvec2 laminaDepthRange;
#if LAMINA_COVERAGE == LAMINA_COVERAGE_FILLED || LAMINA_COVERAGE == LAMINA_COVERAGE_CONSERVATIVE
layout(location = 10) flat LAMINA_STAGE dvec2 laminaEdgeValues0;
layout(location = 11) flat LAMINA_STAGE dvec2 laminaEdgeValues1;
layout(location = 12) flat LAMINA_STAGE dvec2 laminaEdgeValues2;
layout(location = 13) flat LAMINA_STAGE int laminaIsEdgeOn;
#endif
#if LAMINA_SPLIT
layout(location = 9) flat LAMINA_STAGE uint laminaTriangleGrid;
#endif
