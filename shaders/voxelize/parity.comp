// Toggles where the triangles of a chunk cross the centre lines of columns, or enqueues large ones.
//
// One invocation owns one triangle:
//   1. fetch it and find the columns of the part around it;
//   2. if they are many, enqueue it for parity_large.comp;
//   3. else toggle one bit in each column whose centre it owns. Ownership is decided by the same
//      numbers for the two triangles of an edge, so a closed mesh crosses each column evenly.
// Edge-on triangles own no centre.
#include <voxelize/overlap_source.glsl>
#include <voxelize/parity_triangle.glsl>
#include <voxelize/overlap_queue.glsl>

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= laminaOverlap.source.x)
        return;
    dvec3 corners[3];
    if (!laminaFetchTriangle(index, corners))
        return;
    LaminaVoxelBox box = laminaColumnsAround(corners);
    if (any(greaterThan(box.first, box.last)))
        return;
    ivec2 columns = box.last.xy - box.first.xy + 1;
    if (any(greaterThan(columns, ivec2(LAMINA_OVERLAP_SMALL_COLUMNS))) ||
        columns.x * columns.y > LAMINA_OVERLAP_SMALL_COLUMNS) {
        laminaEnqueue(index, box);
        return;
    }
    LaminaColumnTriangle triangle;
    if (!laminaParityTriangle(corners, triangle))
        return;
    for (int y = box.first.y; y <= box.last.y; ++y)
        for (int x = box.first.x; x <= box.last.x; ++x)
            laminaToggle(triangle, x, y);
}
