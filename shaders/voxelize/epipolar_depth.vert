// Vertex stage of a MeshView in a light's depth map: positions from a vertex buffer.
#include <voxelize/epipolar_depth_main.glsl>

layout(location = LAMINA_ATTRIBUTE_POSITION) in vec3 laminaPosition;

LaminaVertex laminaVertex() {
    return LaminaVertex(laminaPosition, vec3(0.0), 0u);
}
