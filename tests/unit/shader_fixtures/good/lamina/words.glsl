// Bits, and words of them – with a byte beyond ASCII.
#include <lamina/bits.glsl>
#include <lamina/shared/constants.glsl>

uvec4 wordsOf(int slice) {
    return uvec4(bitOf(slice));
}
