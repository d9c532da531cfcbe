#include "grid_io/palette.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace lamina::detail {
namespace {

constexpr std::size_t kColorCount = std::size_t{1} << 24;

struct Counted {
    std::uint32_t color;
    std::uint32_t count;
};

int channelOf(std::uint32_t color, int channel) {
    return static_cast<int>(color >> (8 * channel) & 0xffu);
}

/// Some of the colours, and how far they are from their mean.
struct Box {
    std::size_t begin = 0, end = 0;
    glm::dvec3 mean{0.0};
    glm::dvec3 errors{0.0}; ///< Sum of squared differences to the mean, by channel.

    [[nodiscard]] double error() const { return errors.x + errors.y + errors.z; }
    [[nodiscard]] int longest() const {
        if (errors.x >= errors.y)
            return errors.x >= errors.z ? 0 : 2;
        return errors.y >= errors.z ? 1 : 2;
    }
};

Box boxOf(const std::vector<Counted>& colors, std::size_t begin, std::size_t end) {
    Box box{begin, end};
    double weight = 0.0;
    glm::dvec3 sum(0.0), squares(0.0);
    for (std::size_t i = begin; i < end; ++i) {
        const double count = colors[i].count;
        const glm::dvec3 color(channelOf(colors[i].color, 0), channelOf(colors[i].color, 1),
                               channelOf(colors[i].color, 2));
        weight += count;
        sum += count * color;
        squares += count * color * color;
    }
    box.mean = sum / weight;
    box.errors = squares - sum * box.mean;
    return box;
}

/// The place to cut the box's colours, put in order to that end: neither part is empty if there are
/// two different colours.
std::size_t cut(std::vector<Counted>& colors, const Box& box) {
    const int channel = box.longest();
    const double mean = box.mean[channel];
    const auto first = colors.begin() + static_cast<std::ptrdiff_t>(box.begin);
    const auto last = colors.begin() + static_cast<std::ptrdiff_t>(box.end);
    const auto middle = std::partition(first, last, [&](const Counted& counted) {
        return channelOf(counted.color, channel) <= mean;
    });
    return static_cast<std::size_t>(middle - colors.begin());
}

} // namespace

PaletteBuilder::PaletteBuilder()
    : mCounts(kColorCount) {}

Palette PaletteBuilder::build(std::size_t size) const {
    std::vector<Counted> colors;
    for (std::size_t color = 0; color < kColorCount; ++color)
        if (mCounts[color] != 0)
            colors.push_back({static_cast<std::uint32_t>(color), mCounts[color]});

    std::vector<Box> boxes;
    if (!colors.empty())
        boxes.push_back(boxOf(colors, 0, colors.size()));
    if (colors.size() <= size) {
        boxes.clear();
        for (std::size_t i = 0; i < colors.size(); ++i)
            boxes.push_back(boxOf(colors, i, i + 1));
    }
    while (boxes.size() < std::min(size, colors.size())) {
        // One with two colours is left: there are fewer boxes than colours.
        const auto worst = std::ranges::max_element(boxes, [](const Box& a, const Box& b) {
            return std::pair(a.end - a.begin > 1, a.error()) <
                   std::pair(b.end - b.begin > 1, b.error());
        });
        const Box box = *worst;
        const std::size_t middle = cut(colors, box);
        *worst = boxOf(colors, box.begin, middle);
        boxes.push_back(boxOf(colors, middle, box.end));
    }

    Palette palette;
    palette.mIndices.resize(kColorCount);
    for (const Box& box : boxes) {
        const auto index = static_cast<std::uint8_t>(palette.mColors.size());
        std::uint32_t color = 0;
        for (int channel = 0; channel < 3; ++channel)
            color |= static_cast<std::uint32_t>(std::lround(box.mean[channel])) << (8 * channel);
        palette.mColors.push_back(color);
        for (std::size_t i = box.begin; i < box.end; ++i)
            palette.mIndices[colors[i].color] = index;
    }
    return palette;
}

} // namespace lamina::detail
