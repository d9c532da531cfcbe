// The sides of a shadow volume; one invocation owns one edge of the caster and extrudes it as often as it
// bounds the volume: not at all inside a surface that faces the light, twice where two triangles of a sheet
// end in a fold.
#include <shadow_volumes/volume.glsl>

layout(lines_adjacency) in;
layout(triangle_strip, max_vertices = 12) out;

in LaminaCasterVertex {
    vec3 position;
    int index;
} laminaVertexStage[];

LaminaCorner corner(int i) {
    return LaminaCorner(laminaVertexStage[i].position, laminaVertexStage[i].index);
}

void main() {
    int count = laminaSilhouette(corner(0), corner(1), corner(2), corner(3));
    if (count == 0)
        return;
    laminaFindKeptLayers();
    vec3 from = corner(count > 0 ? 1 : 2).position;
    vec3 to = corner(count > 0 ? 2 : 1).position;
    LaminaVolumeCorner a = laminaNearCorner(to), b = laminaNearCorner(from);
    LaminaVolumeCorner c = laminaFarCorner(to), d = laminaFarCorner(from);
    for (int i = 0; i < abs(count); ++i) {
        laminaEmitTriangle(a, b, c);
        // The shadows of a directional light all end in one point.
        if (laminaIsPointLight())
            laminaEmitTriangle(c, b, d);
    }
}
