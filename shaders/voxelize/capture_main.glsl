// main() of the vertex stage that captures a source's triangles by transform feedback: runs the
// source's laminaVertex() and keeps its position.
#include <lamina/vertex_interface.glsl>
#include <lamina/shared/constants.glsl>

layout(xfb_buffer = 0, xfb_stride = 12, xfb_offset = 0) out vec3 laminaCaptured;

LaminaVertex laminaVertex();

void main() {
    laminaCaptured = laminaVertex().position;
}
