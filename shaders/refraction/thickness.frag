// Thickness of an object along the view rays, in world units ([ED06] 3.3). One invocation owns a pixel,
// which is a column of the two slicemaps:
// 1. Counts the column's inner voxels, 128 slices at a time.
// 2. Scales them by the column's depth interval, and that to the length along the ray.
// 3. Counts columns of surfaces that are not closed, and ambiguous ones, for the report: atomics, since
//    all invocations share the two numbers; few columns need them.
// permute LAMINA_INTEGRAL_METHOD = LAMINA_INTEGRAL_ARITHMETIC LAMINA_INTEGRAL_TABLE
#define LAMINA_GRID_COUNT 2
#define LAMINA_GRID_LOCAL_RANGES 1
#include <lamina/shared/refraction_block.glsl>
#define LAMINA_GRID_BLOCK_BINDING LAMINA_THICKNESS_GRID_BINDING
#define LAMINA_GRID_TEXTURE_UNIT LAMINA_THICKNESS_GRID_UNIT
#define LAMINA_GRID_RANGE_UNIT LAMINA_THICKNESS_RANGE_UNIT
#include <lamina/grid.glsl>
#include <lamina/volume_integral.glsl>

layout(std140, binding = LAMINA_THICKNESS_BLOCK_BINDING) uniform LaminaThicknessBlock {
    LaminaThicknessConstants laminaThickness;
};
layout(std430, binding = LAMINA_THICKNESS_REPORT_BINDING) buffer LaminaThicknessReport {
    LaminaThicknessCounts laminaReport;
};

layout(location = 0) out float laminaResult;

#if LAMINA_INTEGRAL_METHOD == LAMINA_INTEGRAL_TABLE
layout(binding = LAMINA_THICKNESS_TABLE_UNIT) uniform sampler2D laminaEvaluation;

// No fetch depends on another one's result: all four of a word may be in flight at once.
void addWord(inout LaminaTableIntegral integral, uint front, uint back) {
    ivec4 entries[4];
    for (int i = 0; i < 4; ++i) {
        uvec2 pair = uvec2(front, back) >> uint(8 * i) & 255u;
        entries[i] = ivec4(texelFetch(laminaEvaluation, ivec2(pair), 0) * 255.0 + 0.5);
    }
    for (int i = 0; i < 4; ++i)
        laminaIntegralAddEntry(integral, entries[i], front >> uint(8 * i) & 255u, back >> uint(8 * i) & 255u);
}
#endif

void main() {
    ivec2 column = ivec2(gl_FragCoord.xy);
    laminaResult = 0.0;
    vec2 range = laminaColumnRange(0, column);
    if (range.x > range.y)
        return;
    uint slices = laminaGridSize(0).z;
    int groups = int(slices + LAMINA_SLICES_PER_GROUP - 1u) / LAMINA_SLICES_PER_GROUP;
    bool isClosed = true;
    bool isAmbiguous = false;
#if LAMINA_INTEGRAL_METHOD == LAMINA_INTEGRAL_TABLE
    LaminaTableIntegral integral = laminaTableIntegralBegin();
    uvec2 first = uvec2(0u);
    for (int group = 0; group < groups; ++group) {
        uvec4 front = laminaColumnBits(0, column, group);
        uvec4 back = laminaColumnBits(1, column, group);
        uvec4 full = front | back;
        isAmbiguous = isAmbiguous || (front & back) != uvec4(0u);
        if (first == uvec2(0u) && full != uvec4(0u)) {
            first = full.x != 0u   ? uvec2(front.x, back.x)
                    : full.y != 0u ? uvec2(front.y, back.y)
                    : full.z != 0u ? uvec2(front.z, back.z)
                                   : uvec2(front.w, back.w);
        }
        addWord(integral, front.x, back.x);
        addWord(integral, front.y, back.y);
        addWord(integral, front.z, back.z);
        addWord(integral, front.w, back.w);
    }
    uint lowest = (first.x | first.y) & (~(first.x | first.y) + 1u);
    isClosed = (first.x & lowest) != 0u && !integral.isInside;
    int count = laminaIntegralCount(integral);
#else
    LaminaIntegral integral = laminaIntegralBegin();
    for (int group = 0; group < groups; ++group)
        laminaIntegralAdd128(integral, laminaColumnBits(0, column, group), laminaColumnBits(1, column, group));
    isClosed = laminaIntegralIsClosed(integral);
    isAmbiguous = integral.isAmbiguous;
    int count = laminaIntegralCount(integral);
#endif
    vec3 ray = vec3(gl_FragCoord.xy * laminaThickness.slope.xy + laminaThickness.slope.zw, 1.0);
    laminaResult = float(count) * ((range.y - range.x) / float(slices)) * length(ray);
    if (!isClosed)
        atomicAdd(laminaReport.openColumns, 1u);
    if (isAmbiguous)
        atomicAdd(laminaReport.ambiguousColumns, 1u);
}
