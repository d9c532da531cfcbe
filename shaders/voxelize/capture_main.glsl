// main() of the vertex stage that captures a source's triangles by transform feedback: runs the
// source's laminaVertex() and keeps its position and, with LAMINA_CAPTURE_SURFACE, what attributes are
// made of.
// permute LAMINA_CAPTURE_SURFACE = 0 1
#include <lamina/vertex_interface.glsl>
#include <lamina/shared/constants.glsl>

#if LAMINA_CAPTURE_SURFACE
layout(xfb_buffer = 0, xfb_stride = LAMINA_CAPTURE_SURFACE_BYTES) out;
layout(xfb_buffer = 0, xfb_offset = LAMINA_CAPTURE_NORMAL_OFFSET) out vec3 laminaCapturedNormal;
layout(xfb_buffer = 0, xfb_offset = LAMINA_CAPTURE_COLOR_OFFSET) out vec4 laminaCapturedColor;
layout(xfb_buffer = 0, xfb_offset = LAMINA_CAPTURE_MATERIAL_OFFSET) out uint laminaCapturedMaterial;
#else
layout(xfb_buffer = 0, xfb_stride = LAMINA_CAPTURE_POSITION_BYTES) out;
#endif
layout(xfb_buffer = 0, xfb_offset = 0) out vec3 laminaCaptured;

LaminaVertex laminaVertex();

void main() {
    LaminaVertex vertex = laminaVertex();
    laminaCaptured = vertex.position;
#if LAMINA_CAPTURE_SURFACE
    laminaCapturedNormal = vertex.normal;
    laminaCapturedColor = laminaVertexColor;
    laminaCapturedMaterial = vertex.material;
#endif
}
