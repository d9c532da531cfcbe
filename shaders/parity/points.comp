// Classifies a batch of points.
//
// One invocation owns one word of the answers: 32 points (bits), 4 (bytes, classes) or 1 (masks), so
// that no two write the same word:
//   1. fetch each point; those with a coordinate that is not a number are outside;
//   2. test it against the sprites of the set;
//   3. pack the answers. Those past the last point are 0.
// permute LAMINA_PARITY_ANSWER = LAMINA_PARITY_ANSWER_BITS LAMINA_PARITY_ANSWER_BYTES LAMINA_PARITY_ANSWER_CLASSES LAMINA_PARITY_ANSWER_MASKS
// permute LAMINA_PARITY_REFINED = 0 1
// permute LAMINA_PARITY_COUNT = 1 4 32
#include <lamina/shared/parity_block.glsl>

#define LAMINA_PARITY_BLOCK_BINDING LAMINA_PARITY_POINT_SET_BINDING
#include <lamina/parity.glsl>

layout(local_size_x = LAMINA_PARITY_POINT_GROUP) in;

layout(std140, binding = LAMINA_PARITY_POINT_BLOCK_BINDING) uniform LaminaPointBlock {
    LaminaPointConstants laminaPoints;
};
layout(std430, binding = LAMINA_PARITY_POINT_INPUT_BINDING) readonly buffer LaminaPointWords {
    float laminaPointWords[];
};
layout(std430, binding = LAMINA_PARITY_POINT_OUTPUT_BINDING) writeonly buffer LaminaAnswerWords {
    uint laminaAnswerWords[];
};

#if LAMINA_PARITY_ANSWER == LAMINA_PARITY_ANSWER_BITS
const uint kPointsPerWord = 32u;
#elif LAMINA_PARITY_ANSWER == LAMINA_PARITY_ANSWER_MASKS
const uint kPointsPerWord = 1u;
#else
const uint kPointsPerWord = 4u;
#endif

uint maskAt(vec3 world) {
#if LAMINA_PARITY_REFINED
    return laminaParityMaskRefined(int(laminaPoints.rule.y), world);
#else
    return laminaParityMask(world);
#endif
}

uint answer(vec3 world) {
#if LAMINA_PARITY_ANSWER == LAMINA_PARITY_ANSWER_MASKS
    return maskAt(world);
#elif LAMINA_PARITY_ANSWER == LAMINA_PARITY_ANSWER_CLASSES
    return uint(laminaParityClassifyCombined(world, int(laminaPoints.rule.x)));
#else
    int shapes = laminaParityCount() / int(laminaPoints.rule.y);
    return uint(laminaParityCombineShapes(maskAt(world), shapes, int(laminaPoints.rule.x)));
#endif
}

void main() {
    uint word = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * LAMINA_PARITY_POINT_GROUP +
                gl_LocalInvocationIndex;
    uint first = word * kPointsPerWord;
    uint count = laminaPoints.place.z;
    if (first >= count)
        return;
    uint answers = 0u;
    for (uint i = 0u; i < min(kPointsPerWord, count - first); ++i) {
        uint place = laminaPoints.place.x + (first + i) * laminaPoints.place.y;
        vec3 world = vec3(laminaPointWords[place], laminaPointWords[place + 1u], laminaPointWords[place + 2u]);
        answers |= answer(world) << (i * (32u / kPointsPerWord));
    }
    laminaAnswerWords[laminaPoints.place.w + word] = answers;
}
