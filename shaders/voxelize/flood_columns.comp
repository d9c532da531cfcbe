// A sweep of the flood along z, towards the last slice (laminaTowards 1) or the first (0).
//
// One invocation owns one column of the part. Word by word, with a carry between them, the flood spreads
// within the word by doubling steps: after step i, 2^i voxels beyond each reached one are reached, unless
// one between is closed. The carry between parts stands in a buffer, a word a column.
#include <voxelize/flood_part.glsl>

layout(location = 0) uniform int laminaTowards;

layout(std430, binding = LAMINA_FLOOD_CARRY_BINDING) buffer LaminaFloodCarry {
    uint laminaCarry[];
};

uint laminaSpread(uint reached, uint open) {
    reached |= open & (reached << 1);
    open &= open << 1;
    reached |= open & (reached << 2);
    open &= open << 2;
    reached |= open & (reached << 4);
    open &= open << 4;
    reached |= open & (reached << 8);
    open &= open << 8;
    return reached | (open & (reached << 16));
}

// Spreads through the four words of a layer in the order of the slices; carry: the bit before them,
// then their last.
uvec4 laminaSpreadUp(uvec4 reached, uvec4 open, inout uint carry) {
    for (int i = 0; i < 4; ++i) {
        reached[i] = laminaSpread(reached[i] | (open[i] & carry), open[i]);
        carry = reached[i] >> 31;
    }
    return reached;
}

void main() {
    ivec3 place;
    if (!laminaPartPlace(place))
        return;
    int layers = laminaPartCounts().z;
    uint column = uint(place.y) * uint(laminaPart.size.x) + uint(place.x);
    bool isUp = laminaTowards != 0;
    bool isFirst = isUp ? laminaPart.low.z == 0 : laminaPart.high.z == laminaPart.size.z - 1;
    uint carry = isFirst ? 0u : laminaCarry[column];
    bool changed = false;
    for (int i = 0; i < layers; ++i) {
        int layer = isUp ? i : layers - 1 - i;
        uint index = laminaPartIndex(place.x, place.y, layer);
        uvec4 found = laminaOutside[index];
        // Nothing to spread.
        if (carry == 0u && found == uvec4(0u))
            continue;
        uvec4 open = ~laminaTexels[index] & laminaSliceBits(layer);
        uvec4 reached;
        if (isUp)
            reached = laminaSpreadUp(found, open, carry);
        else // The same from the other end.
            reached = bitfieldReverse(laminaSpreadUp(bitfieldReverse(found.wzyx), bitfieldReverse(open.wzyx), carry)).wzyx;
        if (reached != found) {
            laminaOutside[index] = reached;
            changed = true;
        }
    }
    laminaCarry[column] = carry;
    // Whoever writes it writes the same.
    if (changed)
        laminaTally[LAMINA_TALLY_CHANGED] = 1u;
}
