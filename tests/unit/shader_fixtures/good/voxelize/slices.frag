#version 450 core
// permute SLICE_WORDS = 1 4
// permute INVERT = 0 1
#include <lamina/words.glsl>
#include <lamina/bits.glsl>

layout(location = 0) flat in int sliceIn;
layout(location = 0) out uvec4 words;

void main() {
    words = wordsOf(sliceIn) * SLICE_WORDS;
#if INVERT
    words = ~words;
#endif
}
