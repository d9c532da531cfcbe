// Vertex stage of a MeshView that receives shadows.
#include <shadow_volumes/receiver_main.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;

LaminaVertex laminaVertex() {
    return LaminaVertex(laminaPosition, vec3(0.0), 0u);
}
