// Notes where the triangles of a chunk cross the centre lines of columns, or enqueues large ones.
//
// One invocation owns one triangle:
//   1. fetch it and find the columns of the part around it;
//   2. if they are many, enqueue it for crossings_large.comp;
//   3. else note a crossing in each column whose centre it owns: a toggle of one bit of the grid, or a
//      signed count in the cells of a direction, or a toggle and a part of the sums of
//      crossing_check.glsl, to which every triangle also adds its edges. Ownership is decided by the same numbers for the
//      two triangles of an edge, so a closed mesh crosses each column evenly, and as often in as out.
// Edge-on triangles own no centre.
// permute LAMINA_CROSSINGS = LAMINA_CROSSINGS_PARITY LAMINA_CROSSINGS_SIGNED LAMINA_CROSSINGS_CHECKED
#include <voxelize/overlap_source.glsl>
#include <voxelize/crossing_triangle.glsl>
#include <voxelize/crossing_parity.glsl>
#include <voxelize/crossing_signed.glsl>
#include <voxelize/overlap_queue.glsl>

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= laminaOverlap.source.x)
        return;
    dvec3 corners[3];
    if (!laminaFetchTriangle(index, corners))
        return;
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    laminaAddEdges(index, corners);
#endif
    LaminaVoxelBox box = laminaColumnsAround(corners);
    if (any(greaterThan(box.first, box.last)))
        return;
    ivec2 columns = box.last.xy - box.first.xy + 1;
    if (any(greaterThan(columns, ivec2(LAMINA_OVERLAP_SMALL_COLUMNS))) ||
        columns.x * columns.y > LAMINA_OVERLAP_SMALL_COLUMNS) {
        laminaEnqueue(index, box);
        return;
    }
    LaminaCrossingTriangle triangle;
    if (!laminaCrossingTriangle(corners, triangle))
        return;
    for (int y = box.first.y; y <= box.last.y; ++y)
        for (int x = box.first.x; x <= box.last.x; ++x)
            laminaCross(triangle, x, y);
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    laminaAddSum(LAMINA_SUM_CROSSINGS, index, laminaCrossings);
#endif
}
