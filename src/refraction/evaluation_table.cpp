#include "refraction/evaluation_table.hpp"

#include "refraction/refraction_constants.hpp"

namespace lamina {
namespace {

constexpr unsigned kBits = 8;

/// A ray's way through the voxels of one pair of masks.
struct Walk {
    unsigned count = 0;
    bool inside = false;
    bool firstIsBack = false;
    unsigned open = 0; ///< One plus the empty voxels after an ambiguous one that is the last.
};

Walk walk(unsigned front, unsigned back, bool entersInside) {
    Walk walk{.inside = entersInside};
    bool isEmpty = true;
    for (unsigned bit = 0; bit < kBits; ++bit) {
        const bool isFront = (front >> bit & 1u) != 0;
        const bool isBack = (back >> bit & 1u) != 0;
        if (!isFront && !isBack) {
            walk.count += walk.inside ? 1 : 0;
            walk.open += walk.open != 0 ? 1 : 0;
            continue;
        }
        if (isBack && !isFront && walk.open != 0)
            walk.count += walk.open - 1;
        walk.firstIsBack |= isEmpty && isBack && !isFront;
        isEmpty = false;
        walk.count += isFront ? 1 : 0;
        walk.inside = isFront && !isBack;
        walk.open = isFront && isBack ? 1 : 0;
    }
    return walk;
}

} // namespace

std::vector<glm::u8vec4> makeEvaluationTable() {
    constexpr unsigned kSize = LAMINA_INTEGRAL_TABLE_SIZE;
    std::vector<glm::u8vec4> table(std::size_t{kSize} * kSize);
    for (unsigned back = 0; back < kSize; ++back)
        for (unsigned front = 0; front < kSize; ++front) {
            const Walk inside = walk(front, back, true);
            const Walk outside = walk(front, back, false);
            const auto value = [](const Walk& walk) {
                return walk.count + (walk.inside ? LAMINA_INTEGRAL_INSIDE : 0);
            };
            table[std::size_t{back} * kSize + front] =
                glm::u8vec4(value(inside), value(outside), outside.firstIsBack, outside.open);
        }
    return table;
}

} // namespace lamina
