// Triangles too large for one invocation, by class (see LAMINA_OVERLAP_CLASS_COUNT).
layout(std430, binding = LAMINA_OVERLAP_QUEUE_BINDING) buffer LaminaOverlapQueue {
    LaminaOverlapClass laminaClasses[LAMINA_OVERLAP_CLASS_COUNT];
    // LAMINA_OVERLAP_CHUNK_TRIANGLES for each class.
    uint laminaQueue[];
};

// Blocks of 8 x 8 columns of a box, in x and y.
ivec2 laminaBlockCounts(LaminaVoxelBox box) {
    return (box.last.xy - box.first.xy + 8) / 8;
}

void laminaEnqueue(uint triangle, LaminaVoxelBox box) {
    ivec2 counts = laminaBlockCounts(box);
    uint limit = uint(LAMINA_OVERLAP_CLASS_BLOCKS);
    int queue = 0;
    // A product of two counts stays below 2^31: a binding holds no more columns.
    for (; queue < LAMINA_OVERLAP_CLASS_COUNT - 1 && uint(counts.x * counts.y) > limit; ++queue)
        limit *= uint(LAMINA_OVERLAP_CLASS_FACTOR);
    uint slot = atomicAdd(laminaClasses[queue].count, 1u);
    laminaQueue[uint(queue * LAMINA_OVERLAP_CHUNK_TRIANGLES) + slot] = triangle;
    // A dispatch takes so many groups along x and no more: the rest along z.
    atomicMax(laminaClasses[queue].groupsX, min(slot + 1u, uint(LAMINA_OVERLAP_MAX_GROUPS)));
    atomicMax(laminaClasses[queue].groupsZ, slot / uint(LAMINA_OVERLAP_MAX_GROUPS) + 1u);
}

// The triangle of this work group: groups (i, g, k) take number k * LAMINA_OVERLAP_MAX_GROUPS + i.
bool laminaDequeue(int queue, out uint triangle) {
    uint slot = gl_WorkGroupID.z * uint(LAMINA_OVERLAP_MAX_GROUPS) + gl_WorkGroupID.x;
    triangle = 0u;
    if (slot >= laminaClasses[queue].count)
        return false;
    triangle = laminaQueue[uint(queue * LAMINA_OVERLAP_CHUNK_TRIANGLES) + slot];
    return true;
}

// The column of this invocation in a block, relative to the box.
ivec2 laminaColumnOfBlock(int block, ivec2 counts) {
    int column = int(gl_LocalInvocationIndex);
    return ivec2(block % counts.x, block / counts.x) * 8 + ivec2(column & 7, column >> 3);
}
