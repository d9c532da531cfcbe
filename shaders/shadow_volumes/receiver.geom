// The texels of the light's map that a receiver's triangles touch; one invocation owns one triangle and
// drops it if the viewer sees nothing of its receiver.
#define LAMINA_SHADOW_WITH_LAYERS 1
#include <shadow_volumes/draw.glsl>
#include <shadow_volumes/receiver_flags.glsl>
#include <shadow_volumes/columns.glsl>

layout(triangles) in;

layout(location = 0) in vec3 laminaOrigin[];

void main() {
    if (laminaReceivers[laminaDraw.draw.x] != 0u)
        laminaEmitColumns(laminaOrigin[0], laminaOrigin[1], laminaOrigin[2]);
}
