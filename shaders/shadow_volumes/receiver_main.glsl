// main() of the vertex stage of receivers: runs the source's laminaVertex().
#include <lamina/shared/constants.glsl>
#include <lamina/vertex_interface.glsl>
#include <shadow_volumes/draw.glsl>

layout(location = 0) out vec3 laminaOrigin; // origin space

LaminaVertex laminaVertex();

void main() {
    laminaOrigin = (laminaDraw.localToOrigin * vec4(laminaVertex().position, 1.0)).xyz;
    gl_Position = laminaFrame.originToClip * vec4(laminaOrigin, 1.0);
}
