// Which of several grids takes a triangle: by the side that faces the grid's camera, or by its material's
// class. For stages that include voxelize/draw_block.glsl; LAMINA_SPLIT 1 if there are several grids.

#if LAMINA_SPLIT
// LAMINA_CLASS_* of material i: component i & 3 of element i >> 2.
layout(std140, binding = LAMINA_CLASS_BLOCK_BINDING) uniform LaminaClassBlock {
    uvec4 laminaClasses[LAMINA_MAX_CLASS_MATERIALS / 4];
};

// h: (column x * w, column y * w, depth) of the corners. A triangle seen edge-on counts as a front.
bool isFront(dvec3 h[3]) {
    bool isPerspective = (laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    // In homogeneous columns the sign holds for triangles that reach behind the eye, too.
    dvec3 a = dvec3(h[0].xy, isPerspective ? h[0].z : 1.0lf);
    dvec3 b = dvec3(h[1].xy, isPerspective ? h[1].z : 1.0lf);
    dvec3 c = dvec3(h[2].xy, isPerspective ? h[2].z : 1.0lf);
    return dot(a, cross(b, c)) * double(laminaDraw.dilation.y) >= 0.0lf;
}

// The grid's number, or one past all grids for a triangle that its material's orientation rule drops.
uint laminaGridOf(dvec3 h[3], uint material) {
    if (laminaDraw.pass.w == LAMINA_SPLIT_FACING)
        return isFront(h) ? 0u : 1u;
    uint last = min(material, uint(LAMINA_MAX_CLASS_MATERIALS - 1));
    uint entry = laminaClasses[last >> 2u][last & 3u];
    bool isTaken = (entry & (isFront(h) ? LAMINA_CLASS_FRONT : LAMINA_CLASS_BACK)) != 0u;
    return isTaken ? entry & LAMINA_CLASS_GRID : laminaDraw.pass.z;
}
#endif
