// Draws point samples of triangles by their weights, one from each of equal shares of all weight, so that
// neighbours in the list are neighbours on the surface.
//
// Launch: ceil(points / 64) work groups; an invocation owns a point:
//   1. find its block and then its triangle by halving the sums;
//   2. place it at random in the triangle.
// Without any weight all points are marked as empty (radius 0).
#include <area_light/random.glsl>
#include <lamina/shared/imperfect_block.glsl>

layout(local_size_x = 64) in;

layout(std140, binding = LAMINA_SAMPLE_UNIFORM_BINDING) uniform LaminaSampleBlock {
    LaminaSampleConstants laminaSample;
};
layout(std430, binding = LAMINA_SAMPLE_TRIANGLE_BINDING) readonly buffer LaminaTriangleBlock {
    float laminaTriangles[];
};
layout(std430, binding = LAMINA_SAMPLE_WEIGHT_BINDING) readonly buffer LaminaWeightBlock {
    float laminaWeights[];
};
layout(std430, binding = LAMINA_SAMPLE_BLOCK_BINDING) readonly buffer LaminaBlockBlock {
    float laminaBlocks[];
};
layout(std430, binding = LAMINA_SAMPLE_POINT_BINDING) writeonly buffer LaminaPointBlock {
    LaminaPointSample laminaPoints[];
};

vec3 corner(uint triangle, uint i) {
    uint word = triangle * 9u + i * 3u;
    return vec3(laminaTriangles[word], laminaTriangles[word + 1u], laminaTriangles[word + 2u]);
}

void main() {
    uint point = gl_GlobalInvocationID.x;
    uint points = laminaSample.counts.w;
    if (point >= points)
        return;
    uint blocks = laminaSample.counts.z;
    float whole = laminaBlocks[blocks - 1u];
    if (!(whole > 0.0)) {
        laminaPoints[point] = LaminaPointSample(vec4(0.0), vec4(0.0), uvec4(0u));
        return;
    }
    float wanted = whole * (float(point) + laminaRandom(3u * point)) / float(points);

    uint low = 0u;
    for (uint high = blocks - 1u; low < high;) {
        uint middle = (low + high) / 2u;
        if (laminaBlocks[middle] > wanted)
            high = middle;
        else
            low = middle + 1u;
    }
    wanted -= low > 0u ? laminaBlocks[low - 1u] : 0.0;
    uint base = low * uint(LAMINA_SAMPLE_BLOCK_TRIANGLES);
    // Rounding may ask for more than the block's sum.
    wanted = min(wanted, 0.999999 * laminaWeights[base + uint(LAMINA_SAMPLE_BLOCK_TRIANGLES) - 1u]);
    uint first = 0u;
    for (uint end = uint(LAMINA_SAMPLE_BLOCK_TRIANGLES) - 1u; first < end;) {
        uint middle = (first + end) / 2u;
        if (laminaWeights[base + middle] > wanted)
            end = middle;
        else
            first = middle + 1u;
    }
    uint triangle = base + first;
    float weight = laminaWeights[triangle] - (first > 0u ? laminaWeights[triangle - 1u] : 0.0);

    vec3 a = corner(triangle, 0u);
    vec3 b = corner(triangle, 1u);
    vec3 c = corner(triangle, 2u);
    vec2 place = vec2(laminaRandom(3u * point + 1u), laminaRandom(3u * point + 2u));
    place = place.x + place.y > 1.0 ? 1.0 - place : place;
    vec3 across = cross(b - a, c - a);
    float area = 0.5 * length(across);
    float share = area * whole / (weight * float(points));
    laminaPoints[point] = LaminaPointSample(vec4(a + place.x * (b - a) + place.y * (c - a), sqrt(share / 3.14159265)),
                                            vec4(across / (2.0 * area), area), uvec4(triangle, 0u, 0u, 0u));
}
