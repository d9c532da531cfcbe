#include <lamina/shared/constants.glsl>

uint bitOf(int slice) {
    return 1u << uint(slice % FIXTURE_WORD_BITS);
}
