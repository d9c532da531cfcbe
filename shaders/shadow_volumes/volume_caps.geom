// The ends of a shadow volume: the caster's triangles that cast, turned to the light, and for a point light
// their shadows at infinity. One invocation owns one triangle.
#include <shadow_volumes/volume.glsl>

layout(triangles) in;
layout(triangle_strip, max_vertices = 6) out;

in LaminaCasterVertex {
    vec3 position;
    int index;
} laminaVertexStage[];

LaminaCorner corner(int i) {
    return LaminaCorner(laminaVertexStage[i].position, laminaVertexStage[i].index);
}

void main() {
    int facing = laminaFacing(corner(0), corner(1), corner(2));
    if (facing == 0)
        return;
    laminaFindKeptLayers();
    vec3 a = corner(0).position;
    vec3 b = corner(facing > 0 ? 1 : 2).position;
    vec3 c = corner(facing > 0 ? 2 : 1).position;
    laminaEmitTriangle(laminaNearCorner(a), laminaNearCorner(b), laminaNearCorner(c));
    if (laminaIsPointLight())
        laminaEmitTriangle(laminaFarCorner(a), laminaFarCorner(c), laminaFarCorner(b));
}
