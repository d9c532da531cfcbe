// Where a flood begins: every voxel on the grid's faces that the surface does not touch. One invocation
// owns one texel.
#include <voxelize/flood_part.glsl>

void main() {
    ivec3 place;
    if (!laminaPartPlace(place))
        return;
    int y = place.y + laminaPart.low.y;
    uvec4 faces = uvec4(0u);
    if (place.x == 0 || place.x == laminaPart.size.x - 1 || y == 0 || y == laminaPart.size.y - 1)
        faces = uvec4(0xffffffffu);
    int slice = laminaPart.low.z + place.z * 128;
    if (slice == 0)
        faces.x |= 1u;
    ivec4 last = laminaPart.size.z - 1 - slice - ivec4(0, 32, 64, 96);
    faces |= mix(uvec4(0u), uvec4(1u) << uvec4(last & 31), equal(last >> 5, ivec4(0)));
    uint index = laminaPartIndex(place.x, place.y, place.z);
    laminaOutside[index] = faces & ~laminaTexels[index] & laminaSliceBits(place.z);
}
