// Sets the bits of one column for one triangle ([ED06] 2.2 to 2.4), or toggles them where the inside is
// wanted (Eisemann and Decoret 2008).
//
// One invocation owns one (triangle, column) pair of one pass:
//   1. the depths that the triangle gives the column by its coverage, cut to the depths that the column's
//      slices divide: the grid's, or with LAMINA_LOCAL 1 those of the near/far map;
//   2. the slices from the first to the last of them. Solid: all slices whose centre lies before the depth
//      at the column's centre, to be toggled; what remains set has an odd number of crossings beyond it;
//   3. their bits: LAMINA_TARGETS render targets of 128 slices each, where logic op OR (Solid: XOR) gathers
//      them; or with LAMINA_TARGETS 0 atomics on the words of a buffer, those that have a bit to set alone.
//      Atomic: other triangles of the column run at the same time.
// With LAMINA_SPLIT 1 target t belongs to grid t % grids, and only those of the triangle's grid get bits.
// permute LAMINA_COVERAGE = LAMINA_COVERAGE_SAMPLED LAMINA_COVERAGE_FILLED LAMINA_COVERAGE_CONSERVATIVE LAMINA_COVERAGE_SOLID
// permute LAMINA_LOCAL = 0 1
// permute LAMINA_SPLIT = 0 1
// permute LAMINA_TARGETS = 0 1 2 4 8
#include <voxelize/slicemap_fragment.glsl>

layout(std140, binding = LAMINA_PASS_GRID_BLOCK_BINDING) uniform LaminaPassGridBlock {
    LaminaGridConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaPassGrid;

#include <lamina/slice_distribution.glsl>

#if LAMINA_LOCAL
layout(rg32f, binding = LAMINA_RANGE_IMAGE_UNIT) readonly uniform image2D laminaRanges;
#endif

#if LAMINA_TARGETS == 0
// The pass's words, from its first group of 128 slices on.
layout(std430, binding = LAMINA_WORDS_BINDING) buffer LaminaWords {
    uint laminaWords[];
};
#else
layout(location = 0) out uvec4 laminaBits[LAMINA_TARGETS];
#endif

// Bits [first, last] of 128; first and last may lie outside.
uvec4 bitRange(int first, int last) {
    ivec4 low = clamp(ivec4(first) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    ivec4 high = clamp(ivec4(last + 1) - ivec4(0, 32, 64, 96), ivec4(0), ivec4(32));
    uvec4 belowLow = mix((uvec4(1u) << uvec4(low & 31)) - 1u, uvec4(0xffffffffu), equal(low, ivec4(32)));
    uvec4 belowHigh = mix((uvec4(1u) << uvec4(high & 31)) - 1u, uvec4(0xffffffffu), equal(high, ivec4(32)));
    return belowHigh & ~belowLow;
}

#if LAMINA_COVERAGE == LAMINA_COVERAGE_SOLID
#define LAMINA_GATHER atomicXor

// A bit for each column: odd number of crossings. Atomic: 32 columns share a word.
layout(r32ui, binding = LAMINA_COLUMN_PARITY_IMAGE) uniform uimage2D laminaColumnParity;

void toggleColumn(ivec2 column) {
    imageAtomicXor(laminaColumnParity, ivec2(column.x >> 5, column.y), 1u << uint(column.x & 31));
}

bool slicesInColumn(out ivec2 slices) {
    dvec2 depths;
    if (!laminaDepthsInColumn(laminaReceivedTriangle(), dvec2(gl_FragCoord.xy), depths))
        return false;
    if (laminaDraw.pass.x == 0u)
        toggleColumn(ivec2(gl_FragCoord.xy));
    slices = ivec2(0, laminaLastCenterBefore(depths.x, laminaDraw));
    return true;
}
#else
#define LAMINA_GATHER atomicOr

// The slices that the triangle sets in this column; false if none.
bool slicesInColumn(out ivec2 slices) {
    double near = laminaDraw.depthRange.x;
    double far = near + 1.0lf / laminaDraw.depthRange.y;
    dvec2 depths;
#if LAMINA_LOCAL
    dvec2 range = dvec2(imageLoad(laminaRanges, ivec2(gl_FragCoord.xy)).xy);
    near = range.x;
    far = -range.y;
    if (near > far || !laminaDepthsBetween(near, far, depths))
        return false;
    double extent = far - near;
    precise dvec2 fractions = extent > 0.0lf ? (depths - near) / extent : dvec2(0.0lf);
    slices.x = laminaSliceOf(fractions.x, laminaDraw);
    slices.y = depths.x == depths.y ? slices.x : laminaSliceOf(fractions.y, laminaDraw);
#else
    if (!laminaDepthsBetween(near, far, depths))
        return false;
    slices.x = laminaSliceAt(depths.x, laminaDraw);
    slices.y = depths.x == depths.y ? slices.x : laminaSliceAt(depths.y, laminaDraw);
#endif
    return true;
}
#endif

// Slices are counted from the pass's first on.
#if LAMINA_TARGETS == 0
void store(ivec2 slices) {
    ivec2 columns = ivec2(laminaDraw.size.xy);
    ivec2 column = ivec2(gl_FragCoord.xy);
    int last = min(slices.y, int(laminaDraw.passDepths.z) - 1);
    int skipped = int(laminaDraw.passDepths.w);
    for (int word = max(slices.x, 0) >> 5; word <= last >> 5; ++word) {
        int first = word << 5;
        uint bits = (0xffffffffu << uint(clamp(slices.x - first, 0, 31))) & (0xffffffffu >> uint(clamp(first + 31 - last, 0, 31)));
        int texel = ((word >> 2) * columns.y + column.y) * columns.x + column.x;
        LAMINA_GATHER(laminaWords[skipped + texel * 4 + (word & 3)], bits);
    }
}
#else
void store(ivec2 slices) {
#if LAMINA_SPLIT
    uint grid = 0u;
#endif
    for (int target = 0; target < LAMINA_TARGETS; ++target) {
        laminaBits[target] = bitRange(slices.x, slices.y);
#if LAMINA_SPLIT
        if (grid != laminaTriangleGrid)
            laminaBits[target] = uvec4(0u);
        if (++grid < laminaDraw.pass.z)
            continue;
        grid = 0u;
#endif
        slices -= LAMINA_SLICES_PER_GROUP;
    }
}
#endif

void main() {
    ivec2 slices;
    if (!slicesInColumn(slices))
        discard;
    store(slices - int(laminaDraw.pass.x));
}
