// Whole boxes and triangles against the sprites of a set: for passes that cull or sort what they draw
// (compute, geometry, mesh shaders), so that only what a surface may cross pays for a test of each
// fragment. Conservative: LAMINA_PARITY_INSIDE and _OUTSIDE hold for every point within, by
// laminaParityInside(); LAMINA_PARITY_BORDER says nothing. Decides by ranges of depth of blocks of 8 x 8
// columns: what is larger than 4 blocks, or lies between the crossings of a column, is border.
// Cost: at most 25 blocks of a gather; a triangle no larger than a block: 1 to 4 blocks.
//
// Macros: those of lamina/parity.glsl.
#ifndef LAMINA_PARITY_BOXES_GLSL
#define LAMINA_PARITY_BOXES_GLSL

#include <lamina/parity.glsl>

// Places of a box's or triangle's points and of the fragments that interpolate them differ by rounding.
const vec3 kLaminaParityMargin = vec3(1.0 / 64.0, 1.0 / 64.0, 1.0e-5);

// The LAMINA_PARITY_RANGES of a block: the four texels around their common corner.
vec4 laminaParityRanges(int sprite, ivec2 block) {
    vec2 corner = vec2(2 * block + 1) / vec2(laminaParitySprite[sprite].size.xy);
    vec3 place = vec3(corner, float(laminaParitySprite[sprite].size.z));
#if LAMINA_PARITY_COUNT == 1
    return textureGather(laminaParityLayers[0], place).wzxy;
#else
    return textureGather(laminaParityLayers[sprite], place).wzxy;
#endif
}

// The class of the box of places [low, high].
int laminaParityPlaceBox(int sprite, vec3 low, vec3 high) {
    if (sprite >= laminaParityCount())
        return LAMINA_PARITY_OUTSIDE;
    int outer = laminaParityInverted(sprite) ? LAMINA_PARITY_INSIDE : LAMINA_PARITY_OUTSIDE;
    int inner = LAMINA_PARITY_INSIDE + LAMINA_PARITY_OUTSIDE - outer;
    low -= kLaminaParityMargin;
    high += kLaminaParityMargin;
    ivec2 columns = ivec2(laminaParitySprite[sprite].size.xy);
    vec3 end = vec3(columns, 1.0);
    if (any(lessThan(high, vec3(0.0))) || any(greaterThan(low, end)))
        return outer;
    ivec2 first = ivec2(clamp(low.xy, vec2(0.0), end.xy - 1.0)) / LAMINA_PARITY_BLOCK;
    ivec2 last = ivec2(clamp(high.xy, vec2(0.0), end.xy - 1.0)) / LAMINA_PARITY_BLOCK;
    // Written so that what is not a number is not decided.
    bool isDecidable = all(lessThanEqual(low, high)) && all(greaterThan(columns, ivec2(1))) &&
                       all(lessThanEqual(last - first, ivec2(LAMINA_PARITY_BLOCK_REACH)));
    if (!isDecidable)
        return LAMINA_PARITY_BORDER;
    bool isOutside = true;
    bool isInside = all(greaterThanEqual(low, vec3(0.0))) && all(lessThanEqual(high, end));
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            vec4 ranges = laminaParityRanges(sprite, ivec2(x, y));
            isOutside = isOutside && (high.z < ranges[LAMINA_PARITY_FIRST] || low.z >= ranges[LAMINA_PARITY_LAST]);
            isInside = isInside && low.z >= ranges[LAMINA_PARITY_ENTER] && high.z < ranges[LAMINA_PARITY_LEAVE];
        }
    return isOutside ? outer : isInside ? inner : LAMINA_PARITY_BORDER;
}

// The class of the world box [low, high].
int laminaParityBox(int sprite, vec3 low, vec3 high) {
    vec3 center = laminaParityPlace(sprite, 0.5 * (low + high));
    vec3 extent = 0.5 * (high - low);
    vec3 reach = vec3(dot(abs(laminaParitySprite[sprite].worldToSprite[0].xyz), extent),
                      dot(abs(laminaParitySprite[sprite].worldToSprite[1].xyz), extent),
                      dot(abs(laminaParitySprite[sprite].worldToSprite[2].xyz), extent));
    return laminaParityPlaceBox(sprite, center - reach, center + reach);
}

// The class of a triangle of world points.
int laminaParityTriangle(int sprite, vec3 a, vec3 b, vec3 c) {
    vec3 placeA = laminaParityPlace(sprite, a);
    vec3 placeB = laminaParityPlace(sprite, b);
    vec3 placeC = laminaParityPlace(sprite, c);
    return laminaParityPlaceBox(sprite, min(placeA, min(placeB, placeC)), max(placeA, max(placeB, placeC)));
}

// The same by the rule of a combination, for all sprites of the set.
int laminaParityTriangleCombined(vec3 a, vec3 b, vec3 c, int rule) {
    uint mask = 0u;
    uint border = 0u;
    for (int sprite = 0; sprite < LAMINA_PARITY_COUNT; ++sprite) {
        int answer = laminaParityTriangle(sprite, a, b, c);
        mask |= answer == LAMINA_PARITY_INSIDE ? 1u << uint(sprite) : 0u;
        border |= answer == LAMINA_PARITY_BORDER ? 1u << uint(sprite) : 0u;
    }
    return laminaParityCombineClasses(mask, border, rule);
}

#endif
