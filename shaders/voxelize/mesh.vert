// Vertex stage of a MeshView: positions from a vertex buffer.
// permute LAMINA_SPLIT = 0 1
#include <voxelize/vertex_main.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;

LaminaVertex laminaVertex() {
    return LaminaVertex(laminaPosition, vec3(0.0), laminaDraw.pass.y);
}
