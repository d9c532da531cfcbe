// What the solid rules report (LAMINA_TALLY_*).
#include <lamina/bits.glsl>
#include <lamina/shared/solid_block.glsl>

layout(std430, binding = LAMINA_SOLID_TALLY_BINDING) buffer LaminaSolidTally {
    uint laminaTally[];
};

// Adds to a number of 64 bits: whoever makes its lower half wrap around carries.
void laminaTallyAdd(uint number, uint amount) {
    if (amount == 0u)
        return;
    uint found = atomicAdd(laminaTally[number], amount);
    if (found + amount < found)
        atomicAdd(laminaTally[number + 1u], 1u);
}
