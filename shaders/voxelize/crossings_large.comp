// crossings.comp for the enqueued triangles of one class; work is shared as in overlap_large.comp.
// permute LAMINA_CROSSINGS = LAMINA_CROSSINGS_PARITY LAMINA_CROSSINGS_SIGNED LAMINA_CROSSINGS_CHECKED
#include <voxelize/overlap_source.glsl>
#include <voxelize/crossing_triangle.glsl>
#include <voxelize/crossing_parity.glsl>
#include <voxelize/crossing_signed.glsl>
#include <voxelize/overlap_queue.glsl>

layout(location = 0) uniform int laminaClass;

void main() {
    uint index;
    if (!laminaDequeue(laminaClass, index))
        return;
    dvec3 corners[3];
    LaminaCrossingTriangle triangle;
    if (!laminaFetchTriangle(index, corners) || !laminaCrossingTriangle(corners, triangle))
        return;
    LaminaVoxelBox box = laminaColumnsAround(corners);
    ivec2 counts = laminaBlockCounts(box);
    for (int block = int(gl_WorkGroupID.y); block < counts.x * counts.y; block += int(gl_NumWorkGroups.y)) {
        ivec2 column = box.first.xy + laminaColumnOfBlock(block, counts);
        if (all(lessThanEqual(column, box.last.xy)))
            laminaCross(triangle, column.x, column.y);
    }
#if LAMINA_CROSSINGS == LAMINA_CROSSINGS_CHECKED
    laminaAddSum(LAMINA_SUM_CROSSINGS, gl_LocalInvocationIndex, laminaCrossings);
#endif
}
