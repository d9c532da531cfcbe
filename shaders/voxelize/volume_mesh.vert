// Vertex stage of a MeshView: position, normal and colour from vertex buffers.
#include <voxelize/volume_vertex.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;
layout(location = LAMINA_ATTRIBUTE_NORMAL) in vec3 laminaNormal;
layout(location = LAMINA_ATTRIBUTE_COLOR) in vec4 laminaColor;

LaminaVertex laminaVertex() {
    laminaVertexColor = laminaColor;
    return LaminaVertex(laminaPosition, laminaNormal, laminaDraw.pass.y);
}
