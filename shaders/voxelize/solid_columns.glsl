// What SolidRule::Parity knows of columns besides the voxels.
layout(std430, binding = LAMINA_OVERLAP_COLUMNS_BINDING) buffer LaminaColumns {
    // Columns that an odd number of triangles crosses: the mesh is open there.
    uint laminaOddColumns;
    uint laminaColumnsUnused[3];
    // A bit for each column: odd number of crossings before the first voxel's centre.
    uint laminaCrossedBefore[];
};
