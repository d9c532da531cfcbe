// Words of 128 bits, as grids and shadow volumes hold them, for every shader stage: bit (i & 31) of component
// i >> 5 is bit i. Components are chosen by comparisons: indexing compiles badly ([WD13] appendix A).
#ifndef LAMINA_BITS_GLSL
#define LAMINA_BITS_GLSL

// A mask of the bits below `bit`; all of them from 128 on, none up to 0.
uvec4 laminaMaskBelow(int bit) {
    ivec4 count = clamp(ivec4(bit) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    // A shift by 32 is undefined: the full words are chosen by comparison.
    return mix((uvec4(1u) << uvec4(count & 31)) - 1u, uvec4(0xffffffffu), equal(count, ivec4(32)));
}

// Number of set bits.
int laminaBitCount(uvec4 bits) {
    ivec4 counts = bitCount(bits);
    return counts.x + counts.y + counts.z + counts.w;
}

// Bit `index`, 0 to 127: 0 or 1.
uint laminaBit(uvec4 bits, int index) {
    uvec2 pair = index < 64 ? bits.xy : bits.zw;
    return ((index & 32) == 0 ? pair.x : pair.y) >> uint(index & 31) & 1u;
}

#endif
