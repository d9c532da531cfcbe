// The volumetric parity test [TD08]: is a world point inside a shape? For every shader stage.
//
//   #define LAMINA_PARITY_COUNT 2          // sprites that the shader can hold, at most 32 (default 1)
//   #define LAMINA_PARITY_BLOCK_BINDING 3  // uniform buffer (default 0)
//   #define LAMINA_PARITY_TEXTURE_UNIT 5   // first of LAMINA_PARITY_COUNT texture units (default 0)
//   #include <lamina/parity.glsl>
//
// SpriteSet::bind() fills them. Below, `sprite` is an index into the set, a constant or dynamically
// uniform expression; a sprite that the set does not have contains nothing. World points and distances
// are in world units. "Place" means sprite coordinates: columns x and y, depth as a fraction of the
// sprite's depth range; layers are crossings of a column's centre line with the surface, nearest first.
//
// A point is answered by the column it lies in: what is nearer to the surface than a column's width may
// be wrong; laminaParityClassify() tells, laminaParityInsideRefined() asks other directions. To decide
// whole triangles before they are drawn: lamina/parity_boxes.glsl.
// Precision: single.
#ifndef LAMINA_PARITY_GLSL
#define LAMINA_PARITY_GLSL

#include <lamina/shared/parity_block.glsl>

#ifndef LAMINA_PARITY_COUNT
#define LAMINA_PARITY_COUNT 1
#endif
#ifndef LAMINA_PARITY_BLOCK_BINDING
#define LAMINA_PARITY_BLOCK_BINDING 0
#endif
#ifndef LAMINA_PARITY_TEXTURE_UNIT
#define LAMINA_PARITY_TEXTURE_UNIT 0
#endif
#if LAMINA_PARITY_COUNT > LAMINA_PARITY_MAX_SPRITES
#error "lamina/parity.glsl: LAMINA_PARITY_COUNT is at most 32"
#endif

// A distance where there is no crossing.
const float kLaminaParityNone = 3.0e38;

layout(std140, binding = LAMINA_PARITY_BLOCK_BINDING) uniform LaminaParityBlock {
    uvec4 laminaParitySprites; // number of sprites in the set; unused
    LaminaSpriteConstants laminaParitySprite[LAMINA_PARITY_MAX_SPRITES];
};

layout(binding = LAMINA_PARITY_TEXTURE_UNIT) uniform sampler2DArray laminaParityLayers[LAMINA_PARITY_COUNT];

// Sprites of the set that this shader can see.
int laminaParityCount() {
    return min(int(laminaParitySprites.x), LAMINA_PARITY_COUNT);
}

float laminaParityLayer(int sprite, ivec2 column, int layer) {
#if LAMINA_PARITY_COUNT == 1
    return texelFetch(laminaParityLayers[0], ivec3(column, layer), 0).r;
#else
    return texelFetch(laminaParityLayers[sprite], ivec3(column, layer), 0).r;
#endif
}

// Is the inside of this sprite what lies outside its shape?
bool laminaParityInverted(int sprite) {
    return (laminaParitySprite[sprite].size.w & LAMINA_PARITY_INVERTED) != 0u;
}

// World point to place.
vec3 laminaParityPlace(int sprite, vec3 world) {
    vec4 point = vec4(world, 1.0);
    return vec3(dot(laminaParitySprite[sprite].worldToSprite[0], point),
                dot(laminaParitySprite[sprite].worldToSprite[1], point),
                dot(laminaParitySprite[sprite].worldToSprite[2], point));
}

// Does a place lie in the sprite's box? Outside of it there is no shape.
bool laminaParityHolds(int sprite, vec3 place) {
    vec2 columns = vec2(laminaParitySprite[sprite].size.xy);
    return sprite < laminaParityCount() && all(greaterThanEqual(place, vec3(0.0))) &&
           all(lessThanEqual(place, vec3(columns, 1.0)));
}

// The column of a place in the box; its upper bounds belong to the last column.
ivec2 laminaParityColumn(int sprite, vec3 place) {
    return min(ivec2(place.xy), ivec2(laminaParitySprite[sprite].size.xy) - 1);
}

// The column that a place lies in, also beside the sprite; of places farther away, or that are not
// numbers, one whose neighbours the sprite does not have either.
ivec2 laminaParityColumnAround(int sprite, vec2 place) {
    vec2 columns = vec2(laminaParitySprite[sprite].size.xy);
    bool isNear = all(greaterThanEqual(place, vec2(-2.0))) && all(lessThanEqual(place, columns + 2.0));
    return isNear ? ivec2(floor(place)) : ivec2(-4);
}

// Layers at or before a depth in [0,1]. Few are marched through until one lies beyond the depth
// ([TD08] 4.2), more are bisected.
int laminaParityLayersBefore(int sprite, ivec2 column, float depth) {
    int layers = int(laminaParitySprite[sprite].size.z);
    if (layers <= LAMINA_PARITY_LINEAR_LAYERS) {
        int layer = 0;
        while (layer < layers && laminaParityLayer(sprite, column, layer) <= depth)
            ++layer;
        return layer;
    }
    int low = 0;
    int high = layers;
    while (low < high) {
        int middle = (low + high) >> 1;
        if (laminaParityLayer(sprite, column, middle) <= depth)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// Crossings of the surface between the sprite's near side and a world point, along the sprite's axis.
int laminaParityCrossings(int sprite, vec3 world) {
    vec3 place = laminaParityPlace(sprite, world);
    if (!laminaParityHolds(sprite, place))
        return 0;
    return laminaParityLayersBefore(sprite, laminaParityColumn(sprite, place), place.z);
}

// Is a world point inside ([TD08] 3.2)? On the surface: inside where the axis enters the shape, outside
// where it leaves it.
bool laminaParityInside(int sprite, vec3 world) {
    return sprite < laminaParityCount() &&
           ((laminaParityCrossings(sprite, world) & 1) != 0) != laminaParityInverted(sprite);
}

// Bit s: inside sprite s.
uint laminaParityMask(vec3 world) {
    uint mask = 0u;
    // A constant bound lets compilers unroll the loop and choose the samplers.
    for (int sprite = 0; sprite < LAMINA_PARITY_COUNT; ++sprite)
        mask |= laminaParityInside(sprite, world) ? 1u << uint(sprite) : 0u;
    return mask;
}

// One answer of the mask of `count` shapes. LAMINA_PARITY_UNION: inside any sprite; INTERSECTION: inside all; DIFFERENCE:
// inside the first and no other.
bool laminaParityCombineShapes(uint mask, int count, int rule) {
    uint every = count == 32 ? 0xffffffffu : (1u << uint(count)) - 1u;
    if (rule == LAMINA_PARITY_INTERSECTION)
        return count > 0 && (mask & every) == every;
    if (rule == LAMINA_PARITY_DIFFERENCE)
        return (mask & every) == 1u;
    return (mask & every) != 0u;
}

bool laminaParityCombine(uint mask, int rule) {
    return laminaParityCombineShapes(mask, laminaParityCount(), rule);
}

// Is a point on the surface of one of `count` shapes also on the surface of their combination? `mask`:
// of that point, in which the shape's own bit does not matter. Draws cut faces: the shapes' surfaces,
// where this holds, inside the solid that is cut.
bool laminaParityIsBoundary(uint mask, int count, int shape, int rule) {
    uint bit = 1u << uint(shape);
    return laminaParityCombineShapes(mask | bit, count, rule) != laminaParityCombineShapes(mask & ~bit, count, rule);
}

// Share, in [0,1], of the four columns around a place that lie inside at its depth, each by its
// bilinear weight: 0 and 1 where they agree. Where one surface passes between them, and its depths
// there differ by at most LAMINA_PARITY_STEEPEST column diagonals, it is interpolated and the answer is
// 0 or 1 too.
float laminaParityShare(int sprite, vec3 place) {
    ivec2 columns = ivec2(laminaParitySprite[sprite].size.xy);
    vec2 corner = place.xy - 0.5;
    ivec2 low = laminaParityColumnAround(sprite, corner);
    vec2 weight = corner - vec2(low);
    vec4 weights = vec4((1.0 - weight.x) * (1.0 - weight.y), weight.x * (1.0 - weight.y),
                        (1.0 - weight.x) * weight.y, weight.x * weight.y);
    ivec4 before = ivec4(0);
    if (sprite < laminaParityCount() && place.z >= 0.0 && place.z <= 1.0) {
        for (int i = 0; i < 4; ++i) {
            ivec2 column = low + ivec2(i & 1, i >> 1);
            if (all(greaterThanEqual(column, ivec2(0))) && all(lessThan(column, columns)))
                before[i] = laminaParityLayersBefore(sprite, column, place.z);
        }
    }
    bool isAnyInside = any(notEqual(before & 1, ivec4(0)));
    float share = isAnyInside ? dot(weights, vec4(before & 1)) : 0.0;
    int least = min(min(before.x, before.y), min(before.z, before.w));
    int most = max(max(before.x, before.y), max(before.z, before.w));
    bool isWithin = all(greaterThanEqual(low, ivec2(0))) && all(lessThan(low, columns - 1));
    if (most == least + 1 && isWithin) {
        vec4 depths;
        for (int i = 0; i < 4; ++i)
            depths[i] = laminaParityLayer(sprite, low + ivec2(i & 1, i >> 1), least);
        float nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
        float farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
        if (farthest - nearest <= LAMINA_PARITY_STEEPEST * laminaParitySprite[sprite].scale.y)
            share = float((least + int(dot(weights, depths) <= place.z)) & 1);
    }
    return laminaParityInverted(sprite) ? 1.0 - share : share;
}

// Inside by `directions` sprites of one shape, sprite `first` and those after it, whose axes differ. The
// first whose columns around the point agree, or can be interpolated, decides; at surfaces nearly
// parallel to its axis they do not ([TD08] 5.2: fuzzy edges). Where no direction decides, the mean of
// their shares does. One direction interpolates, which is enough for smooth surfaces; three, along
// spriteAxes(), are right on 99 % of a shape's bounds with 128 columns and 99.9 % with 1024.
bool laminaParityInsideRefined(int first, int directions, vec3 world) {
    const float kRounding = 1.0e-5;
    float sum = 0.0;
    for (int i = 0; i < directions; ++i) {
        float share = laminaParityShare(first + i, laminaParityPlace(first + i, world));
        if (share <= kRounding || share >= 1.0 - kRounding)
            return share >= 0.5;
        sum += share;
    }
    return sum >= 0.5 * float(directions);
}

// Bit s: inside shape s, whose sprites are `directions` consecutive ones of the set.
uint laminaParityMaskRefined(int directions, vec3 world) {
    uint mask = 0u;
    for (int shape = 0; shape < laminaParityCount() / directions; ++shape)
        mask |= laminaParityInsideRefined(shape * directions, directions, world) ? 1u << uint(shape) : 0u;
    return mask;
}

// LAMINA_PARITY_BORDER if the column of the point and the eight around it disagree, or if one of them
// has a crossing within a column's diagonal of the point's depth; else LAMINA_PARITY_INSIDE or _OUTSIDE.
// A surface within half a column of the point is found, unless the shape or a gap in it is thinner
// than a column.
int laminaParityClassify(int sprite, vec3 world) {
    if (sprite >= laminaParityCount())
        return LAMINA_PARITY_OUTSIDE;
    vec3 place = laminaParityPlace(sprite, world);
    float reach = laminaParitySprite[sprite].scale.y;
    ivec2 columns = ivec2(laminaParitySprite[sprite].size.xy);
    ivec2 center = laminaParityColumnAround(sprite, place.xy);
    int insideCount = 0;
    for (int i = 0; i < 9; ++i) {
        ivec2 column = center + ivec2(i % 3, i / 3) - 1;
        if (any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, columns)) || place.z < -reach ||
            place.z > 1.0 + reach)
            continue;
        int before = laminaParityLayersBefore(sprite, column, min(place.z - reach, 1.0));
        if (before != laminaParityLayersBefore(sprite, column, min(place.z + reach, 1.0)))
            return LAMINA_PARITY_BORDER;
        insideCount += place.z <= 1.0 ? before & 1 : 0;
    }
    if (insideCount != 0 && insideCount != 9)
        return LAMINA_PARITY_BORDER;
    return (insideCount == 9) != laminaParityInverted(sprite) ? LAMINA_PARITY_INSIDE : LAMINA_PARITY_OUTSIDE;
}

// The class of a combination: border where the sprites of `border` decide, whose bits in `mask` are 0.
int laminaParityCombineClasses(uint mask, uint border, int rule) {
    // Union and intersection grow with every bit. The difference grows with the first and shrinks with
    // the others: its extremes are these.
    uint most = rule == LAMINA_PARITY_DIFFERENCE ? mask | (border & 1u) : mask | border;
    uint least = rule == LAMINA_PARITY_DIFFERENCE ? mask | (border & ~1u) : mask;
    if (laminaParityCombine(most, rule) != laminaParityCombine(least, rule))
        return LAMINA_PARITY_BORDER;
    return laminaParityCombine(most, rule) ? LAMINA_PARITY_INSIDE : LAMINA_PARITY_OUTSIDE;
}

int laminaParityClassifyCombined(vec3 world, int rule) {
    uint mask = 0u;
    uint border = 0u;
    for (int sprite = 0; sprite < laminaParityCount(); ++sprite) {
        int answer = laminaParityClassify(sprite, world);
        mask |= answer == LAMINA_PARITY_INSIDE ? 1u << uint(sprite) : 0u;
        border |= answer == LAMINA_PARITY_BORDER ? 1u << uint(sprite) : 0u;
    }
    return laminaParityCombineClasses(mask, border, rule);
}

// What lies around a point along the sprite's axis.
struct LaminaParityProbe {
    bool inside;
    int crossings; // Between the near side and the point.
    float before;  // World distance to the last crossing before the point; kLaminaParityNone: none.
    float after;   // World distance to the next crossing; kLaminaParityNone: none.
};

// Crossings that coincide in pairs bound nothing and are passed over.
LaminaParityProbe laminaParityProbePlace(int sprite, ivec2 column, float depth) {
    LaminaParityProbe probe = LaminaParityProbe(laminaParityInverted(sprite), 0, kLaminaParityNone, kLaminaParityNone);
    bool isNumber = abs(depth) < kLaminaParityNone;
    if (sprite >= laminaParityCount() || !isNumber || any(lessThan(column, ivec2(0))) ||
        any(greaterThanEqual(column, ivec2(laminaParitySprite[sprite].size.xy))))
        return probe;
    int layers = int(laminaParitySprite[sprite].size.z);
    float range = laminaParitySprite[sprite].scale.x;
    int crossings = laminaParityLayersBefore(sprite, column, min(depth, 1.0));
    if (depth >= 0.0 && depth <= 1.0) {
        probe.crossings = crossings;
        probe.inside = ((crossings & 1) != 0) != probe.inside;
    }
    int next = crossings;
    while (next + 1 < layers && laminaParityLayer(sprite, column, next) == laminaParityLayer(sprite, column, next + 1))
        next += 2;
    if (next < layers) {
        float layer = laminaParityLayer(sprite, column, next);
        probe.after = layer <= 1.0 ? (layer - depth) * range : kLaminaParityNone;
    }
    int last = crossings - 1;
    while (last > 0 && laminaParityLayer(sprite, column, last) == laminaParityLayer(sprite, column, last - 1))
        last -= 2;
    if (last >= 0)
        probe.before = (depth - laminaParityLayer(sprite, column, last)) * range;
    return probe;
}

LaminaParityProbe laminaParityProbe(int sprite, vec3 world) {
    vec3 place = laminaParityPlace(sprite, world);
    return laminaParityProbePlace(sprite, laminaParityColumnAround(sprite, place.xy), place.z);
}

// Distance to the nearest crossing of the point's column, along the sprite's axis; negative inside.
// kLaminaParityNone (negative inside an inverted sprite) where the column has none.
float laminaParityDistance(int sprite, vec3 world) {
    LaminaParityProbe probe = laminaParityProbe(sprite, world);
    float distance = min(probe.before, probe.after);
    return probe.inside ? -distance : distance;
}

// Outward unit normal of the surface near a point, from the distances of the columns around it, or zero
// where they have no crossing. For points within some columns of the surface.
vec3 laminaParityNormal(int sprite, vec3 world) {
    vec3 place = laminaParityPlace(sprite, world);
    ivec2 column = laminaParityColumnAround(sprite, place.xy);
    float range = laminaParitySprite[sprite].scale.x;
    LaminaParityProbe probe = laminaParityProbePlace(sprite, column, place.z);
    float here = min(probe.before, probe.after);
    if (here == kLaminaParityNone)
        return vec3(0.0);
    here = probe.inside ? -here : here;
    // Growth of the signed distance by a column in x and y, in depth ranges; by a depth range along the axis.
    vec3 growth = vec3(0.0, 0.0, (probe.before < probe.after) != probe.inside ? 1.0 : -1.0);
    for (int axis = 0; axis < 2; ++axis) {
        float sum = 0.0;
        float count = 0.0;
        for (int side = -1; side <= 1; side += 2) {
            ivec2 neighbour = column;
            neighbour[axis] += side;
            LaminaParityProbe other = laminaParityProbePlace(sprite, neighbour, place.z);
            float distance = min(other.before, other.after);
            if (distance == kLaminaParityNone)
                continue;
            sum += ((other.inside ? -distance : distance) - here) * float(side);
            count += 1.0;
        }
        growth[axis] = count > 0.0 ? sum / (count * range) : 0.0;
    }
    vec3 normal = growth.x * laminaParitySprite[sprite].worldToSprite[0].xyz +
                  growth.y * laminaParitySprite[sprite].worldToSprite[1].xyz +
                  growth.z * laminaParitySprite[sprite].worldToSprite[2].xyz;
    return normalize(normal);
}

#endif
