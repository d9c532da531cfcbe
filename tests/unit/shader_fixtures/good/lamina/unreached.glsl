// permute UNREACHED_SCALE = 1 2
#include <lamina/bits.glsl>

uint unreached(int slice) {
    return bitOf(slice * UNREACHED_SCALE);
}
