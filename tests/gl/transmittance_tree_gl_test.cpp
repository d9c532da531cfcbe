// Transmittance shadows of a tree against exact crossings by ray casting, beside the error that a
// perfect slicemap of the same columns and slices must have.

#include "gl/support/transmittance_probe.hpp"

#include "transmittance/light_faces.hpp"

#include <reference/leaf_rays.hpp>
#include <support/tree.hpp>

#include <cmath>
#include <random>

namespace lamina {
namespace {

constexpr std::uint32_t kColumns = 512;
constexpr float kSigma = 0.1f;
const glm::dvec3 kToSun = glm::normalize(glm::dvec3(-0.45, 1.0, -0.62));

/// Half on leaves, half on the ground that the tree shades.
std::vector<reference::SurfacePoint> leafAndGroundPoints(const TriangleMesh& leaves,
                                                         std::size_t count) {
    auto points = reference::sampleSurface(leaves, count / 2, 1);
    const auto above = reference::sampleSurface(leaves, count - count / 2, 2);
    for (const reference::SurfacePoint& leaf : above) {
        reference::SurfacePoint ground;
        ground.position = leaf.position - leaf.position.y / kToSun.y * kToSun;
        points.push_back(ground);
    }
    return points;
}

class TransmittanceTreeGlTest : public test::TransmittanceGlTest {
protected:
    struct Errors {
        double rms = 0.0;
        double exactShare = 0.0; ///< Of points with the exact number of leaves.
    };

    Errors errors(std::span<const double> counts) const {
        Errors sum;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const double difference =
                std::pow(1.0 - kSigma, counts[i]) - std::pow(1.0 - kSigma, mExact[i]);
            sum.rms += difference * difference;
            sum.exactShare += std::abs(counts[i] - mExact[i]) < 1e-3 ? 1.0 : 0.0;
        }
        const auto count = static_cast<double>(counts.size());
        return {std::sqrt(sum.rms / count), sum.exactShare / count};
    }

    std::vector<double> probeCounts(Transmittance& transmittance,
                                    const TransmittanceSettings& settings, bool withNormals) {
        EXPECT_TRUE(transmittance.setSettings(settings));
        std::vector<test::ProbePoint> probes;
        for (const auto& point : mPoints)
            probes.push_back({point.position, withNormals ? point.normal : glm::dvec3(0.0)});
        std::vector<double> counts;
        for (const glm::vec3& value : probe(transmittance, probes))
            counts.push_back(std::log(static_cast<double>(value.x)) / std::log(1.0 - kSigma));
        return counts;
    }

    const example::Tree mTree = example::makeChestnut();
    const reference::LeafRays mRays{mTree.leaves};
    std::vector<reference::SurfacePoint> mPoints = leafAndGroundPoints(mTree.leaves, 100'000);
    std::vector<unsigned> mExact = [&] {
        std::vector<unsigned> counts;
        for (const auto& point : mPoints)
            counts.push_back(mRays.between(point, 30.0 * kToSun));
        return counts;
    }();
};

TEST_F(TransmittanceTreeGlTest, SampledIsIdealAndLinearIsBetter) {
    auto leaves = MeshBuffers::upload(device(), mTree.leaves).value();
    const GeometrySource sources[] = {leaves.view()};
    TransmittanceCasters casters;
    casters.leaves = sources;
    casters.bounds = mTree.leaves.bounds();
    TransmittanceLight light;
    light.direction = -kToSun;

    struct Case {
        std::uint32_t slices;
        bool local;
    };
    for (const Case& test : {Case{32, false}, Case{128, true}, Case{1024, false}}) {
        TransmittanceDesc desc;
        desc.size = {kColumns, kColumns, test.slices};
        desc.localRanges = test.local;
        auto transmittance = Transmittance::create(device(), desc).value();
        const auto stats = transmittance.prepare(light, casters);
        ASSERT_TRUE(stats) << stats.error().text;

        const GridTransform grid =
            fitLightFaces(light, casters.bounds, desc.size, 1, 0.0).value().grids.front();
        reference::IdealSlicemap slicemap(mRays, grid, test.local);
        std::vector<double> idealCounts;
        for (const auto& point : mPoints)
            idealCounts.push_back(slicemap.countNearer(point.position));
        const Errors ideal = errors(idealCounts);
        const auto sampledCounts = probeCounts(transmittance, plain(kSigma), false);
        const Errors sampled = errors(sampledCounts);
        const Errors linear = errors(probeCounts(transmittance, attenuating(kSigma), true));
        std::printf("%4u slices, %s: ideal %.4f (%.1f %% exact), sampled %.4f (%.1f %%), linear "
                    "%.4f\n",
                    test.slices, test.local ? "local" : "uniform", ideal.rms,
                    100.0 * ideal.exactShare, sampled.rms, 100.0 * sampled.exactShare, linear.rms);
        EXPECT_NEAR(sampled.rms, ideal.rms, 0.02 * ideal.rms);
        EXPECT_NEAR(sampled.exactShare, ideal.exactShare, 0.02 * ideal.exactShare);
        EXPECT_LT(linear.rms, ideal.rms);

        // Where the two differ, the ray caster's and the shader's single precision put a crossing
        // or the point on different sides of a slice or a leaf's edge.
        std::size_t differing = 0;
        for (std::size_t i = 0; i < idealCounts.size(); ++i)
            differing += std::abs(idealCounts[i] - sampledCounts[i]) > 1e-3 ? 1 : 0;
        EXPECT_LT(differing, mPoints.size() / 100);
    }
}

} // namespace
} // namespace lamina
