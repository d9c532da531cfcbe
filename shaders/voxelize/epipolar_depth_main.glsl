// main() of the vertex stage of a light's depth map: runs the source's laminaVertex().
#include <lamina/shared/constants.glsl>
#include <lamina/vertex_interface.glsl>

layout(std140, binding = LAMINA_DRAW_BLOCK_BINDING) uniform LaminaEpipolarDrawBlock {
    mat4 laminaLocalToClip;
};

LaminaVertex laminaVertex();

void main() {
    gl_Position = laminaLocalToClip * vec4(laminaVertex().position, 1.0);
}
