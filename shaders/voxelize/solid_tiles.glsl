// Tiles: runs of 64 texels along x. Those with contested voxels are listed, part by part.
#include <voxelize/solid_part.glsl>
#include <voxelize/solid_tally.glsl>

layout(std430, binding = LAMINA_SOLID_TILES_BINDING) buffer LaminaSolidTiles {
    uint laminaTiles[];
};

// The part's indirect dispatch over its listed tiles; the fourth word is their number.
uint laminaTileDispatch() {
    return uint(LAMINA_TALLY_DISPATCHES + laminaPart.high.w * 4);
}

// Lists the tile of this work group, whose number along x, column y and layer fit one word.
void laminaListTile() {
    uint dispatch = laminaTileDispatch();
    uint slot = atomicAdd(laminaTally[dispatch + 3u], 1u);
    laminaTiles[uint(laminaPart.size.w) + slot] = gl_WorkGroupID.x | (gl_WorkGroupID.z << 8) | (gl_WorkGroupID.y << 16);
    atomicMax(laminaTally[dispatch], min(slot + 1u, uint(LAMINA_OVERLAP_MAX_GROUPS)));
    atomicMax(laminaTally[dispatch + 1u], slot / uint(LAMINA_OVERLAP_MAX_GROUPS) + 1u);
}

// Column x, column y and layer of this invocation in the listed tile of its work group; false outside
// the part and past the last tile.
bool laminaTilePlace(out ivec3 place) {
    uint slot = gl_WorkGroupID.y * uint(LAMINA_OVERLAP_MAX_GROUPS) + gl_WorkGroupID.x;
    place = ivec3(0);
    if (slot >= laminaTally[laminaTileDispatch() + 3u])
        return false;
    uint tile = laminaTiles[uint(laminaPart.size.w) + slot];
    place = ivec3((tile & 0xffu) * LAMINA_OVERLAP_GROUP_SIZE + gl_LocalInvocationIndex, tile >> 16, (tile >> 8) & 0xffu);
    return place.x < laminaPart.size.x;
}
