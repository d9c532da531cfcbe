// Row, slot and first bit of a diagonal's cells over the texel at a place of the part.
ivec3 laminaTexelCells(ivec3 place) {
    ivec3 voxel = laminaPart.low.xyz + ivec3(place.xy, place.z * 128);
    // Diagonals step along x.
    return laminaCellPlace(voxel.y, voxel.z, voxel.x);
}
