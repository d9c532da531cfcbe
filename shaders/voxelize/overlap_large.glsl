// The enqueued triangles of one class and the voxels that they meet.
//
// Several work groups, along y, own one triangle. Each takes every groups-th block of 8 x 8 columns of
// the triangle's box, an invocation a column, so that a triangle of any size is shared and no
// invocation loops for long. Doubles throughout: coordinates relative to one corner of a large triangle
// are too large for floats.
#define Real double
#define Real2 dvec2
#define Real3 dvec3
const double kVertical = 1.0e-12lf;
#include <voxelize/overlap_source.glsl>
#include <voxelize/overlap_triangle.glsl>
#include <voxelize/overlap_queue.glsl>

layout(location = 0) uniform int laminaClass;

void main() {
    uint triangle;
    if (!laminaDequeue(laminaClass, triangle))
        return;
    dvec3 corners[3];
    if (!laminaFetchTriangle(triangle, corners))
        return;
    dvec3 low = min(corners[0], min(corners[1], corners[2]));
    dvec3 high = max(corners[0], max(corners[1], corners[2]));
    LaminaVoxelBox box = laminaVoxelsAround(low, high, LAMINA_OVERLAP_ALLOWANCE);
    if (any(greaterThan(box.first, box.last)))
        return;

    dvec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    // The part of the box in the grid is where precision counts.
    dvec3 origin = dvec3(box.first);
    dvec3 local[3] = dvec3[](corners[0] - origin, corners[1] - origin, corners[2] - origin);
    laminaBeginTriangle(triangle, corners);
    LaminaOverlapTriangle t = laminaOverlapTriangle(box.first, local, normal);
    ivec3 last = box.last - box.first;
    ivec2 counts = laminaBlockCounts(box);
    for (int block = int(gl_WorkGroupID.y); block < counts.x * counts.y; block += int(gl_NumWorkGroups.y)) {
        ivec2 column = laminaColumnOfBlock(block, counts);
        dvec2 place = dvec2(column);
        dvec2 columns = laminaRowColumns(t, place.y);
        if (any(greaterThan(column, last.xy)) || place.x < columns.x || place.x > columns.y)
            continue;
        dvec2 slices = laminaColumnSlices(t, place.x, place.y);
        dvec2 rowSlices = laminaRowSlices(t, place.y);
        // Compared as doubles: the bounds of steep edges are beyond any int.
        double front = ceil(max(max(slices.x, rowSlices.x), 0.0lf));
        double back = floor(min(min(slices.y, rowSlices.y), double(last.z)));
        if (front <= back)
            laminaVisitSlices(column.x + t.base.x, column.y + t.base.y, int(front) + t.base.z, int(back) + t.base.z);
    }
}
