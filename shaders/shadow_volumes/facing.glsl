// Which way casters' triangles are turned.
#include <shadow_volumes/draw.glsl>

struct LaminaCorner {
    vec3 position;
    int index;
};

void laminaOrder(inout LaminaCorner a, inout LaminaCorner b, inout float parity) {
    if (a.index <= b.index)
        return;
    LaminaCorner c = a;
    a = b;
    b = c;
    parity = -parity;
}

// How often the triangle a, b, c casts: 1 if it is turned to the light, -1 if away and the caster is a
// sheet, which casts by both sides; else 0. A triangle gives the same answer from all three of its edges
// and from its cap, bit for bit: corners are ordered by their index first, and the arithmetic is `precise`.
int laminaFacing(LaminaCorner a, LaminaCorner b, LaminaCorner c) {
    float parity = 1.0;
    laminaOrder(a, b, parity);
    laminaOrder(b, c, parity);
    laminaOrder(a, b, parity);
    vec3 p = b.position - a.position;
    vec3 q = c.position - a.position;
    vec3 light = laminaIsPointLight() ? laminaFrame.light.xyz - a.position : laminaFrame.light.xyz;
    precise float side = (p.y * q.z - p.z * q.y) * light.x + (p.z * q.x - p.x * q.z) * light.y + (p.x * q.y - p.y * q.x) * light.z;
    side *= parity;
    if (side > 0.0)
        return 1;
    return side < 0.0 && (laminaDraw.draw.y & LAMINA_SHADOW_SHEET) != 0u ? -1 : 0;
}

// How often an edge from b to c bounds the volume, signed by direction: its triangles are a, b, c and
// c, b, d. Where d is one of them there is one triangle.
int laminaSilhouette(LaminaCorner a, LaminaCorner b, LaminaCorner c, LaminaCorner d) {
    return laminaFacing(a, b, c) - (d.index == b.index ? 0 : laminaFacing(c, b, d));
}
