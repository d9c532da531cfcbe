#include "parity_bench.hpp"

#include <lamina/parity/point_classifier.hpp>
#include <lamina/parity/sprite_builder.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <reference/point_parity.hpp>

#include <random>

namespace lamina::bench {
namespace {

/// A way to ask about points.
struct Variant {
    const char* name;
    std::size_t sprites;      ///< Of the shape, along its axes.
    std::uint32_t directions; ///< PointQuery::directions
};
constexpr std::array<Variant, 4> kVariants = {{{"one", 1, 0},
                                               {"one, interpolated", 1, 1},
                                               {"two directions", 2, 2},
                                               {"three directions", 3, 3}}};

/// A shape's sprites along the axes, and what asks them.
class AxisSprites {
public:
    AxisSprites(const Device& device, const TriangleMesh& mesh)
        : mBuffers(need(MeshBuffers::upload(device, mesh)))
        , mBounds(mesh.bounds())
        , mBuilder(need(SpriteBuilder::create(device)))
        , mSet(need(SpriteSet::create(device)))
        , mClassifier(need(PointClassifier::create(device))) {
        for (std::size_t i = 0; i < spriteAxes().size(); ++i)
            mSprites.push_back(need(DepthSprite::create(device)));
    }

    void build(std::size_t sprites, std::uint32_t columns) {
        const GeometrySource source = mBuffers.view();
        for (std::size_t i = 0; i < sprites; ++i)
            need(mBuilder.buildAndWait(
                {&source, 1}, need(fitSprite(mBounds, spriteAxes()[i], columns)), mSprites[i]));
    }
    std::vector<std::uint8_t> classify(const Variant& variant, std::span<const glm::vec3> points) {
        std::vector<SpriteInstance> instances;
        for (std::size_t i = 0; i < variant.sprites; ++i)
            instances.push_back({.sprite = &mSprites[i]});
        need(mSet.update(instances));
        return need(mClassifier.download(mSet, points, {.directions = variant.directions}));
    }
    [[nodiscard]] std::uint64_t bytes(std::size_t sprites) const {
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < sprites; ++i)
            sum += mSprites[i].gpuBytes();
        return sum;
    }

private:
    MeshBuffers mBuffers;
    Box3 mBounds;
    SpriteBuilder mBuilder;
    SpriteSet mSet;
    PointClassifier mClassifier;
    std::vector<DepthSprite> mSprites;
};

std::vector<glm::vec3> randomPoints(const Box3& box, std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& point : points)
        point =
            glm::vec3(box.min + glm::dvec3(unit(random), unit(random), unit(random)) * box.size());
    return points;
}

} // namespace

void printAccuracy(const Device& device, std::span<const Shape> meshes, std::size_t count) {
    std::printf("\nAccuracy: share of %zu random points of the bounds that differ from exact ray "
                "parity, by columns\n%-16s %-18s",
                count, "shape", "sprites");
    constexpr std::uint32_t kColumns[] = {128, 256, 512, 1024, 2048};
    for (const std::uint32_t columns : kColumns)
        std::printf(" %9u", columns);
    std::printf("\n");
    for (const Shape& shape : meshes) {
        const auto points = randomPoints(shape.mesh.bounds(), count);
        const auto expected = reference::pointParity(shape.mesh, points, Axis::X);
        AxisSprites sprites(device, shape.mesh);
        std::array<std::string, kVariants.size()> rows;
        for (const std::uint32_t columns : kColumns) {
            sprites.build(spriteAxes().size(), columns);
            for (std::size_t v = 0; v < kVariants.size(); ++v) {
                const auto answers = sprites.classify(kVariants[v], points);
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < count; ++i)
                    wrong += (answers[i] != 0) != (expected[i] != 0) ? 1 : 0;
                char text[32];
                std::snprintf(text, sizeof text, " %8.4f%%",
                              1e2 * static_cast<double>(wrong) / static_cast<double>(count));
                rows[v] += text;
            }
        }
        for (std::size_t v = 0; v < rows.size(); ++v)
            std::printf("%-16s %-18s%s\n", v == 0 ? shape.name.c_str() : "", kVariants[v].name,
                        rows[v].c_str());
    }
}

void printVariants(const Device& device, std::span<const Shape> meshes, std::size_t count,
                   int rounds) {
    constexpr std::uint32_t kColumns = 1024;
    std::printf("\nCost of the variants at %u columns: processor time, median of %d; points: %zu "
                "at random\n%-16s %-18s %10s %10s %12s\n",
                kColumns, rounds, count, "shape", "sprites", "MiB", "build", "a point");
    for (const Shape& shape : meshes) {
        const auto points = randomPoints(shape.mesh.bounds(), count);
        AxisSprites sprites(device, shape.mesh);
        for (const Variant& variant : kVariants) {
            const auto times = measure<2>({[&] { sprites.build(variant.sprites, kColumns); },
                                           [&] { (void)sprites.classify(variant, points); }},
                                          rounds);
            std::printf("%-16s %-18s %10.1f %7.1f ms %9.1f ns\n",
                        &variant == &kVariants[0] ? shape.name.c_str() : "", variant.name,
                        static_cast<double>(sprites.bytes(variant.sprites)) / (1u << 20u),
                        times[0].processor, 1e6 * times[1].processor / static_cast<double>(count));
        }
    }
}

} // namespace lamina::bench
