// Transmittance shadows: how much of a light's light reaches a world point through leaves, for every
// shader stage of an engine. [ED06] 3.1, [CLN11] 3.
//
//   <the lines of Transmittance::shaderDefines(uniformBufferBinding, textureUnit)>
//   #include <lamina/transmittance.glsl>
//
// Transmittance::bind() with the same numbers fills what it reads. It includes lamina/grid.glsl for
// grids of its own, so a shader cannot query others beside it. Texels are fetched, never filtered by
// the sampler: no derivatives are needed, and any control flow may surround the calls.
//
// Precision: single.
#ifndef LAMINA_TRANSMITTANCE_GLSL
#define LAMINA_TRANSMITTANCE_GLSL

#include <lamina/shared/transmittance_block.glsl>

#ifndef LAMINA_TRANSMITTANCE_MODEL
#define LAMINA_TRANSMITTANCE_MODEL LAMINA_TRANSMITTANCE_LEAF_COUNT
#endif
#ifndef LAMINA_TRANSMITTANCE_FACES
#define LAMINA_TRANSMITTANCE_FACES 1
#endif
#ifndef LAMINA_TRANSMITTANCE_CLASSES
#define LAMINA_TRANSMITTANCE_CLASSES 1
#endif
#ifndef LAMINA_TRANSMITTANCE_LOCAL_RANGES
#define LAMINA_TRANSMITTANCE_LOCAL_RANGES 0
#endif
#ifndef LAMINA_TRANSMITTANCE_BLOCK_BINDING
#define LAMINA_TRANSMITTANCE_BLOCK_BINDING 0
#endif
#ifndef LAMINA_TRANSMITTANCE_TEXTURE_UNIT
#define LAMINA_TRANSMITTANCE_TEXTURE_UNIT 0
#endif

#define LAMINA_GRID_COUNT LAMINA_TRANSMITTANCE_FACES
#define LAMINA_GRID_BLOCK_BINDING (LAMINA_TRANSMITTANCE_BLOCK_BINDING + LAMINA_TRANSMITTANCE_GRID_BLOCKS)
#define LAMINA_GRID_TEXTURE_UNIT (LAMINA_TRANSMITTANCE_TEXTURE_UNIT + LAMINA_TRANSMITTANCE_WORD_UNIT)
#define LAMINA_GRID_RANGE_UNIT (LAMINA_GRID_TEXTURE_UNIT + LAMINA_GRID_COUNT)
#define LAMINA_GRID_LOCAL_RANGES LAMINA_TRANSMITTANCE_LOCAL_RANGES
#include <lamina/grid.glsl>

layout(std140, binding = LAMINA_TRANSMITTANCE_BLOCK_BINDING) uniform LaminaTransmittanceBlock {
    LaminaTransmittanceConstants laminaTransmittanceBlock;
};
layout(binding = LAMINA_TRANSMITTANCE_TEXTURE_UNIT + LAMINA_TRANSMITTANCE_OPAQUE_UNIT)
uniform sampler2DArray laminaTransmittanceOpaque;
#if LAMINA_TRANSMITTANCE_MODEL == LAMINA_TRANSMITTANCE_ABSORPTION
// Sum of the absorption of a column's slices up to and with this one; faces follow each other in z.
layout(binding = LAMINA_TRANSMITTANCE_TEXTURE_UNIT + LAMINA_TRANSMITTANCE_SUM_UNIT)
uniform sampler3D laminaTransmittanceSums;
#endif

// The axis of a cube around the light that a direction from it points along: +x, -x, +y, -y, +z, -z.
int laminaCubeFace(vec3 direction) {
    vec3 size = abs(direction);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    return 2 * axis + (direction[axis] < 0.0 ? 1 : 0);
}

int laminaCubeEntry(ivec4 entries[2], int face) {
    return face < 4 ? entries[0][face] : entries[1][face - 4];
}

// How a coordinate with gradient `along` changes on the plane with this normal for a step of one in two
// others with gradients `x` and `y`: solves along = result.x * x + result.y * y + (any) * normal. Zero
// for an unknown normal. Planes nearly parallel to the light are taken a little less steep: nothing
// extends that far.
vec2 laminaPlaneSlope(vec3 along, vec3 x, vec3 y, vec3 normal) {
    const float kLeastCosine = 0.05;
    vec3 light = cross(x, y);
    float facing = dot(light, normal);
    float least = kLeastCosine * length(light) * length(normal);
    if (least == 0.0)
        return vec2(0.0);
    if (abs(facing) < least)
        facing = facing < 0.0 ? -least : least;
    return vec2(dot(cross(along, y), normal), dot(cross(x, along), normal)) / facing;
}

// The cells that a box of this width around `center` overlaps, and the share of the box in cell i of an
// axis: cells first, first + 1, ... first + count - 1. A box of no width lies in one cell.
struct LaminaBoxFilter {
    ivec2 first;
    ivec2 count;
    vec2 low;
    vec2 high;
};

LaminaBoxFilter laminaBoxFilter(vec2 center, float width) {
    LaminaBoxFilter box;
    box.low = center - 0.5 * width;
    box.high = center + 0.5 * width;
    box.first = ivec2(floor(box.low));
    box.count = width > 0.0 ? ivec2(ceil(box.high)) - box.first : ivec2(1);
    return box;
}

float laminaBoxWeight(LaminaBoxFilter box, ivec2 cell) {
    vec2 size = box.high - box.low;
    if (size.x <= 0.0)
        return 1.0;
    vec2 overlap = min(box.high, vec2(cell) + 1.0) - max(box.low, vec2(cell));
    overlap = max(overlap, vec2(0.0));
    return overlap.x * overlap.y / (size.x * size.y);
}

// Where a point stands among the slices of a column: continuous, negative before its near depth, and
// beyond its far depth growing by the mean slice. Before an empty column: negative.
float laminaTransmittanceSlice(int grid, ivec2 column, float depth) {
    vec2 range = laminaColumnRange(grid, column);
    if (!(depth > range.x) || range.x > range.y)
        return -1.0;
    float beyond = depth - range.y;
    if (beyond <= 0.0)
        return laminaSliceCoordinate(grid, range, depth);
    float slices = float(laminaGridSize(grid).z);
    return slices * (1.0 + min(beyond / max(range.y - range.x, 1e-30), 1e4));
}

// The slice that holds a coordinate: far belongs to the last one; beyond it, any past the last.
int laminaTransmittanceIndex(int grid, float slice) {
    int slices = int(laminaGridSize(grid).z);
    return slice == float(slices) ? slices - 1 : int(floor(slice));
}

// What the slices before coordinate `slice` sum up to, given the sum of the slices before index k and
// the values of slices k, k - 1 and k - 2, where k is the index of slice - 1: linear between slices at
// slice - 1, and from there on with the mean of the two slices before (SliceLookup::Linear).
float laminaExtrapolatedSum(float before, vec3 values, float slice) {
    float part = fract(slice);
    float passed = before + part * values.x;
    return passed + 0.5 * (part * values.x + values.y + (1.0 - part) * values.z);
}

#if LAMINA_TRANSMITTANCE_MODEL == LAMINA_TRANSMITTANCE_LEAF_COUNT

// The exponent of T = 2^exponent that a column of a face adds for a point of this depth.
vec3 laminaTransmittanceExponent(int face, ivec2 column, float depth) {
    float slice = laminaTransmittanceSlice(face, column, depth);
    if (slice < 0.0)
        return vec3(0.0);
    bool isLinear = (laminaTransmittanceBlock.modes.y & LAMINA_TRANSMITTANCE_LINEAR_SLICES) != 0u;
    vec3 exponent = vec3(0.0);
    for (int i = 0; i < LAMINA_TRANSMITTANCE_CLASSES; ++i) {
        float count;
        if (isLinear) {
            int k = int(floor(slice)) - 1;
            vec3 values = vec3(laminaVoxelSet(face, i, ivec3(column, k)), laminaVoxelSet(face, i, ivec3(column, k - 1)),
                               laminaVoxelSet(face, i, ivec3(column, k - 2)));
            count = laminaExtrapolatedSum(float(laminaCountNearer(face, i, column, k)), values, slice);
        } else {
            count = float(laminaCountNearer(face, i, column, laminaTransmittanceIndex(face, slice)));
        }
        exponent += count * laminaTransmittanceBlock.attenuation[i].rgb;
    }
    return exponent;
}

#else

float laminaAbsorptionUpTo(int face, ivec2 column, int slice) {
    ivec3 size = ivec3(laminaGridSize(face));
    if (slice < 0 || any(lessThan(column, ivec2(0))) || any(greaterThanEqual(column, size.xy)))
        return 0.0;
    return texelFetch(laminaTransmittanceSums, ivec3(column, face * size.z + min(slice, size.z - 1)), 0).r;
}

// The same, in the unit of absorption: all channels alike.
vec3 laminaTransmittanceExponent(int face, ivec2 column, float depth) {
    float slice = laminaTransmittanceSlice(face, column, depth);
    if (slice < 0.0)
        return vec3(0.0);
    if ((laminaTransmittanceBlock.modes.y & LAMINA_TRANSMITTANCE_LINEAR_SLICES) == 0u)
        return vec3(laminaAbsorptionUpTo(face, column, laminaTransmittanceIndex(face, slice) - 1));
    int k = int(floor(slice)) - 1;
    vec4 sums = vec4(laminaAbsorptionUpTo(face, column, k), laminaAbsorptionUpTo(face, column, k - 1),
                     laminaAbsorptionUpTo(face, column, k - 2), laminaAbsorptionUpTo(face, column, k - 3));
    return vec3(laminaExtrapolatedSum(sums.y, sums.xyz - sums.yzw, slice));
}

#endif

// The exponent at a world point, averaged over the filter's columns of a face.
vec3 laminaTransmittanceFace(int face, vec3 world, vec3 normal) {
    LaminaGridPoint place = laminaGridPoint(face, world);
    LaminaGridConstants constants = laminaGrid[face].constants;
    if (!place.isInside || place.depth <= constants.depthRange.x)
        return vec3(0.0);
    bool isPerspective = (constants.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    vec3 along = constants.worldToColumn[2].xyz;
    vec3 perspective = isPerspective ? along : vec3(0.0);
    float w = isPerspective ? place.depth : 1.0;
    vec2 slope = laminaPlaneSlope(along, (constants.worldToColumn[0].xyz - place.column.x * perspective) / w,
                                  (constants.worldToColumn[1].xyz - place.column.y * perspective) / w, normal);
    float depth = place.depth - laminaTransmittanceBlock.lookup.z;
    LaminaBoxFilter box = laminaBoxFilter(place.column, laminaTransmittanceBlock.lookup.x);
    vec3 exponent = vec3(0.0);
    for (int y = 0; y < box.count.y; ++y)
        for (int x = 0; x < box.count.x; ++x) {
            ivec2 column = box.first + ivec2(x, y);
            float weight = laminaBoxWeight(box, column);
            if (weight > 0.0)
                exponent += weight * laminaTransmittanceExponent(
                                         face, column, depth + dot(slope, vec2(column) + 0.5 - place.column));
        }
    return exponent;
}

// The share of the light that opaque casters let pass to a world point.
float laminaOpaqueTransmittance(vec3 world, vec3 normal) {
    if ((laminaTransmittanceBlock.modes.y & LAMINA_TRANSMITTANCE_OPAQUE_MAP) == 0u)
        return 1.0;
    vec4 light = laminaTransmittanceBlock.light;
    int layer = laminaCubeEntry(laminaTransmittanceBlock.opaqueLayers, laminaCubeFace(world - light.xyz * light.w));
    if (layer < 0)
        return 1.0;
    vec3 towards = light.xyz - light.w * world;
    vec3 biased = world + laminaTransmittanceBlock.lookup.w * normalize(towards);
    mat4 toTexel = laminaTransmittanceBlock.worldToOpaque[layer];
    vec4 point = toTexel * vec4(biased, 1.0);
    if (point.w <= 0.0)
        return 1.0;
    vec3 place = point.xyz / point.w;
    ivec2 texels = ivec2(laminaTransmittanceBlock.modes.zw);
    if (any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(texels))))
        return 1.0;
    mat4 rows = transpose(toTexel);
    vec2 slope = laminaPlaneSlope((rows[2].xyz - place.z * rows[3].xyz) / point.w,
                                  (rows[0].xyz - place.x * rows[3].xyz) / point.w,
                                  (rows[1].xyz - place.y * rows[3].xyz) / point.w, normal);
    float empty = laminaTransmittanceBlock.scalars.y;
    float nearer = laminaTransmittanceBlock.scalars.z;
    LaminaBoxFilter box = laminaBoxFilter(place.xy, laminaTransmittanceBlock.lookup.y);
    vec2 lit = vec2(0.0); // Weights of lit texels, of all.
    for (int y = 0; y < box.count.y; ++y)
        for (int x = 0; x < box.count.x; ++x) {
            ivec2 texel = box.first + ivec2(x, y);
            float weight = laminaBoxWeight(box, texel);
            float stored = texelFetch(laminaTransmittanceOpaque, ivec3(clamp(texel, ivec2(0), texels - 1), layer), 0).r;
            float depth = place.z + dot(slope, vec2(texel) + 0.5 - place.xy);
            bool isLit = stored == empty || nearer * depth <= nearer * stored;
            lit += vec2(isLit ? weight : 0.0, weight);
        }
    return lit.x / lit.y;
}

// Is a world point outside a spot's cone?
bool laminaOutsideCone(vec3 world) {
    vec4 cone = laminaTransmittanceBlock.cone;
    return cone.w > -1.5 && dot(normalize(world - laminaTransmittanceBlock.light.xyz), cone.xyz) < cone.w;
}

// The share of red, green and blue light that reaches a world point. normal: the surface's, world space,
// any length and side; zero where there is no surface or it is unknown.
vec3 laminaTransmittance(vec3 world, vec3 normal) {
    if (laminaOutsideCone(world))
        return vec3(0.0);
    // The opaque map decides first ([ED06] 3.1).
    float lit = laminaOpaqueTransmittance(world, normal);
    if (lit == 0.0)
        return vec3(0.0);
    vec4 light = laminaTransmittanceBlock.light;
    int face = laminaCubeEntry(laminaTransmittanceBlock.gridFaces, laminaCubeFace(world - light.xyz * light.w));
    vec3 exponent = vec3(0.0);
    // Grids are chosen by a loop: their index must be the same in all invocations.
    for (int i = 0; i < LAMINA_TRANSMITTANCE_FACES; ++i)
        if (i == face)
            exponent = laminaTransmittanceFace(i, world, normal);
#if LAMINA_TRANSMITTANCE_MODEL == LAMINA_TRANSMITTANCE_LEAF_COUNT
    return lit * exp2(exponent);
#else
    vec3 sum = laminaTransmittanceBlock.scalars.x * exponent;
    bool isLinear = (laminaTransmittanceBlock.modes.y & LAMINA_TRANSMITTANCE_LINEAR_FORM) != 0u;
    return lit * (isLinear ? max(1.0 - sum, vec3(0.0)) : exp(-sum));
#endif
}

#endif
