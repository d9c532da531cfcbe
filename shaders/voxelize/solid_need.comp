// Marks the lines of a diagonal that meet a contested voxel: the others need no counts.
//
// One invocation owns one texel of a listed tile, whose contested voxels lie on lines in a run of words,
// one more than it has because cells have a margin. Atomic: other voxels lie on the same lines.
#include <voxelize/solid_tiles.glsl>
#include <voxelize/solid_cells.glsl>
#include <voxelize/solid_texel_cells.glsl>

layout(std430, binding = LAMINA_SOLID_CONTESTED_BINDING) readonly buffer LaminaContested {
    uvec4 laminaContested[];
};
layout(std430, binding = LAMINA_SOLID_MARKS_BINDING) buffer LaminaSolidMarks {
    uint laminaNeededLines[];
};

void laminaMark(int row, int word, uint lines) {
    uint index = laminaTouchedIndex(row, word);
    if ((laminaNeededLines[index] & lines) != lines)
        atomicOr(laminaNeededLines[index], lines);
}

void main() {
    ivec3 place;
    if (!laminaTilePlace(place))
        return;
    uvec4 contested = laminaContested[laminaPartIndex(place.x, place.y, place.z)];
    if (contested == uvec4(0u))
        return;
    ivec3 start = laminaTexelCells(place);
    if (start.x < laminaLine.rows.x || start.x >= laminaLine.rows.x + laminaLine.rows.y)
        return;
    int word = start.z >> 5;
    int shift = start.z & 31;
    for (int i = 0; i < 4; ++i) {
        laminaMark(start.x, word, contested[i] << shift);
        if (++word == laminaLine.period.w)
            word = 0;
        // A shift by 32 is undefined: in two steps.
        laminaMark(start.x, word, (contested[i] >> (31 - shift)) >> 1);
    }
}
