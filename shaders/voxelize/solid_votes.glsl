// Votes on the voxels of a part: counts of four bits, whose planes are three buffers and, the highest,
// the grid itself. A majority of 14 is there when the last direction has voted. All planes are zero
// between two calls.
layout(std430, binding = LAMINA_SOLID_VOTES_BINDING) buffer LaminaVotePlane {
    uvec4 laminaVotes[];
} laminaVotePlanes[3];
