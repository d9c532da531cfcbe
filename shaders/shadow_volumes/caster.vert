// Vertex stage of casters: positions in origin space. `precise`: every pass must find the same ones, or
// volumes leak along the edges that triangles share.
#include <lamina/shared/constants.glsl>
#include <shadow_volumes/draw.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;

out LaminaCasterVertex {
    vec3 position;
    int index;
} laminaVertexStage;

void main() {
    mat4 m = laminaDraw.localToOrigin;
    precise vec3 position = m[0].xyz * laminaPosition.x + m[1].xyz * laminaPosition.y + m[2].xyz * laminaPosition.z + m[3].xyz;
    laminaVertexStage.position = position;
    laminaVertexStage.index = gl_VertexID;
}
