// Captures a MeshView whose buffers cannot be read as storage buffers. Its material is known without.
// permute LAMINA_CAPTURE_SURFACE = 0 1
#include <voxelize/capture_main.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;
#if LAMINA_CAPTURE_SURFACE
layout(location = LAMINA_ATTRIBUTE_NORMAL) in vec3 laminaNormal;
layout(location = LAMINA_ATTRIBUTE_COLOR) in vec4 laminaColor;
#endif

LaminaVertex laminaVertex() {
#if LAMINA_CAPTURE_SURFACE
    laminaVertexColor = laminaColor;
    return LaminaVertex(laminaPosition, laminaNormal, 0u);
#else
    return LaminaVertex(laminaPosition, vec3(0.0), 0u);
#endif
}
