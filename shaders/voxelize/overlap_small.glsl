// The triangles of a chunk and the voxels that they meet; large triangles are enqueued.
//
// One invocation owns one triangle:
//   1. fetch it and clip its box to the part of the grid;
//   2. if it is not small (LAMINA_OVERLAP_SMALL_VOXELS), enqueue it for overlap_large.glsl;
//   3. else work out its inequalities and, row by row and column by column, visit the slices they leave.
// Floats suffice: coordinates are relative to the triangle's own voxel, formed in double precision.
// Degenerate triangles (segments, points) need no special case.
#define Real float
#define Real2 vec2
#define Real3 vec3
// Planes steeper than this are as good as vertical.
const float kVertical = 1.0e-7;
#include <voxelize/overlap_source.glsl>
#include <voxelize/overlap_triangle.glsl>
#include <voxelize/overlap_queue.glsl>

void voxelize(LaminaOverlapTriangle t, ivec3 first, ivec3 last) {
    for (int y = first.y; y <= last.y; ++y) {
        // Compared as floats: the bounds of steep edges are beyond any int.
        vec2 columns = laminaRowColumns(t, float(y));
        vec2 rowSlices = laminaRowSlices(t, float(y));
        float firstX = ceil(max(columns.x, float(first.x)));
        float lastX = floor(min(columns.y, float(last.x)));
        for (float x = firstX; x <= lastX; x += 1.0) {
            vec2 slices = laminaColumnSlices(t, x, float(y));
            float front = ceil(max(max(slices.x, rowSlices.x), float(first.z)));
            float back = floor(min(min(slices.y, rowSlices.y), float(last.z)));
            if (front <= back)
                laminaVisitSlices(int(x) + t.base.x, y + t.base.y, int(front) + t.base.z, int(back) + t.base.z);
        }
    }
}

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle >= laminaOverlap.source.x)
        return;
    dvec3 corners[3];
    if (!laminaFetchTriangle(triangle, corners))
        return;
    dvec3 low = min(corners[0], min(corners[1], corners[2]));
    dvec3 high = max(corners[0], max(corners[1], corners[2]));
    LaminaVoxelBox box = laminaVoxelsAround(low, high, LAMINA_OVERLAP_ALLOWANCE);
    if (any(greaterThan(box.first, box.last)))
        return;
    ivec2 columns = box.last.xy - box.first.xy + 1;
    if (any(greaterThan(high - low, dvec3(LAMINA_OVERLAP_SMALL_VOXELS))) ||
        columns.x * columns.y > LAMINA_OVERLAP_SMALL_COLUMNS) {
        laminaEnqueue(triangle, box);
        return;
    }
    dvec3 origin = floor(low);
    ivec3 base = ivec3(origin);
    dvec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    vec3 local[3] = vec3[](vec3(corners[0] - origin), vec3(corners[1] - origin), vec3(corners[2] - origin));
    laminaBeginTriangle(triangle, corners);
    voxelize(laminaOverlapTriangle(base, local, vec3(normal)), box.first - base, box.last - base);
}
