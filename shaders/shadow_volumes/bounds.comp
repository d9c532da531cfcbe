// Fits the faces of the light's map to what the viewer sees.
//
// Launch: the view's pixels in groups of 16 x 16. An invocation owns one pixel:
//   1. projects its point to its face;
//   2. widens the group's bounds (shared atomics, so that few reach the buffer);
//   3. after a barrier, one invocation a face adds the group's bounds to the buffer's (atomics: groups
//      race).
#define LAMINA_SHADOW_BOUNDS_ACCESS
#include <shadow_volumes/bounds.glsl>
#include <shadow_volumes/pixel.glsl>

shared uint groupBounds[6][4];

void main() {
    uint index = gl_LocalInvocationIndex;
    if (index < 6u)
        groupBounds[index] = uint[4](0xffffffffu, 0xffffffffu, 0u, 0u);
    barrier();
    vec3 point;
    if (laminaVisiblePoint(point)) {
        uint face = laminaFaceOf(point);
        vec3 projected = laminaFacePoint(face, point).position;
        vec2 at = projected.xy / projected.z;
        if (!any(isnan(at)) && !any(isinf(at))) {
            atomicMin(groupBounds[face][0], laminaOrdered(at.x));
            atomicMin(groupBounds[face][1], laminaOrdered(at.y));
            atomicMax(groupBounds[face][2], laminaOrdered(at.x));
            atomicMax(groupBounds[face][3], laminaOrdered(at.y));
        }
    }
    barrier();
    if (index < 6u && groupBounds[index][0] <= groupBounds[index][2]) {
        atomicMin(laminaBounds[index].x, groupBounds[index][0]);
        atomicMin(laminaBounds[index].y, groupBounds[index][1]);
        atomicMax(laminaBounds[index].z, groupBounds[index][2]);
        atomicMax(laminaBounds[index].w, groupBounds[index][3]);
    }
}
