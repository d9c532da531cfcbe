// The texels of the light's map that a caster's silhouette touches; one invocation owns one edge.
#include <shadow_volumes/facing.glsl>
#include <shadow_volumes/columns.glsl>

layout(lines_adjacency) in;

in LaminaCasterVertex {
    vec3 position;
    int index;
} laminaVertexStage[];

LaminaCorner corner(int i) {
    return LaminaCorner(laminaVertexStage[i].position, laminaVertexStage[i].index);
}

void main() {
    if (laminaSilhouette(corner(0), corner(1), corner(2), corner(3)) != 0)
        laminaEmitColumns(corner(1).position, corner(2).position, corner(2).position);
}
