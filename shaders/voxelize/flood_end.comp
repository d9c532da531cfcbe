// The solid: all that the flood did not reach; counts the surface and what it encloses. One invocation
// owns one texel.
#include <voxelize/flood_part.glsl>

void main() {
    ivec3 place;
    if (!laminaPartPlace(place))
        return;
    uint index = laminaPartIndex(place.x, place.y, place.z);
    uvec4 surface = laminaTexels[index];
    uvec4 solid = ~laminaOutside[index] & laminaSliceBits(place.z);
    if (solid == surface && solid == uvec4(0u))
        return;
    laminaTexels[index] = solid;
    laminaTallyAdd(LAMINA_TALLY_DOUBTFUL, uint(laminaBitCount(surface)));
    laminaTallyAdd(LAMINA_TALLY_ENCLOSED, uint(laminaBitCount(solid & ~surface)));
}
