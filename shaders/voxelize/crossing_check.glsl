// Sums that tell, but for one mesh in 2^60, when parity along z is all that SolidRule::Voted needs.
//
// Edges: each triangle adds for each edge from a to b a number that is random in the two positions and
// changes its sign with the direction. The sum vanishes if every edge is passed as often one way as the
// other: then the mesh is closed and consistently oriented, and the winding number of a point is the
// same along every ray.
//
// Crossings and changes: each crossing adds its sign times a number that is random in its column and
// slice, each change along a filled column the sign of the change times the same number. The sums are
// equal, or opposite for meshes turned inside out, if the changes are the crossings: then no winding
// number but 0 and one of 1 and -1 occurs, and an odd one is any but zero.
//
// All sums are modulo 2^32 and thus independent of the order.
#include <voxelize/solid_tally.glsl>

// A word that depends on all bits of another.
uint laminaMixed(uint bits) {
    bits ^= bits >> 16;
    bits *= 0x7feb352du;
    bits ^= bits >> 15;
    bits *= 0x846ca68bu;
    return bits ^ (bits >> 16);
}

// Two words, random in one or two other pairs.
uvec2 laminaRandom(uvec2 a) {
    uint first = laminaMixed(a.x ^ laminaMixed(a.y + 0x9e3779b9u));
    return uvec2(first, laminaMixed(a.y ^ laminaMixed(first + 0x85ebca6bu)));
}
uvec2 laminaRandom(uvec2 a, uvec2 b) {
    return laminaRandom(laminaRandom(a) + b * 0x9e3779b1u);
}

void laminaAddSum(uint sum, uint slot, uvec2 amount) {
    if (amount == uvec2(0u))
        return;
    uint place = uint(LAMINA_TALLY_SUMS) + slot % uint(LAMINA_SUM_SLOTS) * uint(LAMINA_SUM_STRIDE) + sum;
    atomicAdd(laminaTally[place], amount.x);
    atomicAdd(laminaTally[place + 1u], amount.y);
}

// The number of a crossing or a change between slices `slice` and `slice` + 1 of a column.
uvec2 laminaPlaceNumber(int x, int y, int slice) {
    return laminaRandom(uvec2(uint(x) | (uint(y) << 16), uint(slice)));
}

uvec2 laminaPositionNumber(dvec3 position) {
    // 0 has two signs, which compare equal.
    position += 0.0lf;
    return laminaRandom(laminaRandom(unpackDouble2x32(position.x), unpackDouble2x32(position.y)), unpackDouble2x32(position.z));
}

void laminaAddEdges(uint slot, dvec3 corners[3]) {
    uvec2 numbers[3] = uvec2[](laminaPositionNumber(corners[0]), laminaPositionNumber(corners[1]), laminaPositionNumber(corners[2]));
    uvec2 sum = uvec2(0u);
    for (int i = 0; i < 3; ++i) {
        uvec2 a = numbers[i];
        uvec2 b = numbers[(i + 1) % 3];
        sum += laminaRandom(a, b) - laminaRandom(b, a);
    }
    laminaAddSum(LAMINA_SUM_EDGES, slot, sum);
}
