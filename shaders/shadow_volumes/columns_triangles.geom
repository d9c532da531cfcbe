// The texels of the light's map that a caster's triangles touch; one invocation owns one triangle and
// drops it if it does not cast. Degenerate triangles never cast.
#include <shadow_volumes/facing.glsl>
#include <shadow_volumes/columns.glsl>

layout(triangles) in;

in LaminaCasterVertex {
    vec3 position;
    int index;
} laminaVertexStage[];

LaminaCorner corner(int i) {
    return LaminaCorner(laminaVertexStage[i].position, laminaVertexStage[i].index);
}

void main() {
    if (laminaFacing(corner(0), corner(1), corner(2)) != 0)
        laminaEmitColumns(corner(0).position, corner(1).position, corner(2).position);
}
