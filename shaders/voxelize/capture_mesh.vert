// Captures a MeshView whose buffers cannot be read as storage buffers.
#include <voxelize/capture_main.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;

LaminaVertex laminaVertex() {
    return LaminaVertex(laminaPosition, vec3(0.0), 0u);
}
