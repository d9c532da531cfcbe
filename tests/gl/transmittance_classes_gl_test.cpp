// Leaves of three colours around a point light in their midst: six grids of three slicemaps each,
// against exact crossings by ray casting and against perfect slicemaps of the same voxels.

#include "gl/support/transmittance_probe.hpp"

#include "transmittance/light_faces.hpp"
#include "transmittance/settings.hpp"

#include <reference/leaf_rays.hpp>
#include <reference/shapes.hpp>

#include <array>
#include <cmath>
#include <random>

namespace lamina {
namespace {

constexpr std::size_t kClasses = 3;
constexpr float kSigma = 0.2f;
const Box3 kBounds{{-3.0, -2.5, -3.0}, {3.0, 3.5, 3.0}};

class TransmittanceClassesGlTest : public test::TransmittanceGlTest {
protected:
    using Counts = std::array<double, kClasses>;

    static TransmittanceLight lamp() {
        TransmittanceLight light;
        light.kind = LightKind::Point;
        light.position = {0.2, 0.3, -0.1};
        return light;
    }

    std::array<TriangleMesh, kClasses> makeLeaves() const {
        std::array<TriangleMesh, kClasses> leaves;
        for (std::uint32_t i = 0; i < kClasses; ++i)
            leaves[i] = reference::makeTriangleSoup({kBounds.min + 0.5, kBounds.max - 0.5}, 700,
                                                    0.45f, 21 + i);
        return leaves;
    }

    static std::vector<glm::dvec3> makePoints(std::size_t count) {
        std::mt19937 random(4);
        const auto unit = [&] { return (random() + 0.5) / 4294967296.0; };
        std::vector<glm::dvec3> points;
        while (points.size() < count) {
            const glm::dvec3 point =
                kBounds.min + glm::dvec3(unit(), unit(), unit()) * kBounds.size();
            if (glm::distance(point, lamp().position) > 0.3)
                points.push_back(point);
        }
        return points;
    }

    /// Leaves of each class before each point, as T tells: class i takes from colour i alone.
    std::vector<Counts> probeCounts(Transmittance& transmittance,
                                    std::span<const glm::dvec3> points) {
        TransmittanceSettings settings = plain(0.0f);
        for (int i = 0; i < static_cast<int>(kClasses); ++i)
            settings.attenuation[static_cast<std::size_t>(i)][i] = kSigma;
        EXPECT_TRUE(transmittance.setSettings(settings));
        std::vector<test::ProbePoint> probes;
        for (const glm::dvec3& point : points)
            probes.push_back({point});
        std::vector<Counts> counts;
        for (const glm::vec3& value : probe(transmittance, probes)) {
            Counts of{};
            for (int i = 0; i < static_cast<int>(kClasses); ++i)
                of[static_cast<std::size_t>(i)] = std::log(value[i]) / std::log(1.0 - kSigma);
            counts.push_back(of);
        }
        return counts;
    }

    /// Perfect slicemaps, of the face that sees the point.
    static std::vector<Counts> idealCounts(const LightFaces& faces,
                                           std::span<const reference::LeafRays> rays,
                                           std::span<const glm::dvec3> points) {
        std::vector<reference::IdealSlicemap> maps;
        for (const GridTransform& grid : faces.grids)
            for (const reference::LeafRays& leaves : rays)
                maps.emplace_back(leaves, grid, false);
        std::vector<Counts> counts;
        for (const glm::dvec3& point : points) {
            const glm::dvec3 along = point - lamp().position;
            const glm::dvec3 size = glm::abs(along);
            const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
            const auto face =
                faces.ofAxis[static_cast<std::size_t>(2 * axis) + (along[axis] < 0.0 ? 1 : 0)];
            Counts of{};
            for (std::size_t i = 0; i < kClasses; ++i)
                of[i] = maps[static_cast<std::size_t>(face) * kClasses + i].countNearer(point);
            counts.push_back(of);
        }
        return counts;
    }

    /// RMS error of T over points and classes.
    static double rmsError(std::span<const Counts> found, std::span<const Counts> exact) {
        double squares = 0.0;
        for (std::size_t i = 0; i < found.size(); ++i)
            for (std::size_t k = 0; k < kClasses; ++k) {
                const double difference =
                    std::pow(1.0 - kSigma, found[i][k]) - std::pow(1.0 - kSigma, exact[i][k]);
                squares += difference * difference;
            }
        return std::sqrt(squares / static_cast<double>(found.size() * kClasses));
    }
};

TEST_F(TransmittanceClassesGlTest, SixFacesOfThreeClassesAreIdeal) {
    const auto leaves = makeLeaves();
    std::vector<reference::LeafRays> rays;
    std::vector<MeshBuffers> buffers;
    std::vector<GeometrySource> sources;
    std::vector<Material> materials(kClasses);
    for (std::uint32_t i = 0; i < kClasses; ++i) {
        rays.emplace_back(leaves[i]);
        buffers.push_back(MeshBuffers::upload(device(), leaves[i]).value());
        MeshView view = buffers.back().view();
        view.materialId = i;
        sources.emplace_back(view);
        materials[i].colorClass = i;
    }
    const auto points = makePoints(20'000);
    std::vector<Counts> exact;
    for (const glm::dvec3& point : points) {
        Counts of{};
        for (std::size_t i = 0; i < kClasses; ++i)
            of[i] = rays[i].between({.position = point}, lamp().position - point);
        exact.push_back(of);
    }
    TransmittanceCasters casters;
    casters.leaves = sources;
    casters.materials = materials;
    casters.bounds = kBounds;

    TransmittanceDesc desc;
    desc.size = {128, 128, 160}; // two layers of 128 slices for each class
    desc.maxFaces = 6;
    desc.classes = kClasses;
    auto uniform = Transmittance::create(device(), desc).value();
    auto stats = uniform.prepare(lamp(), casters);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_EQ(stats->faces, 6u);
    EXPECT_EQ(stats->passes, 6u);
    const auto found = probeCounts(uniform, points);

    const LightFaces faces =
        fitLightFaces(lamp(), kBounds, desc.size, desc.maxFaces, kWidestFilter).value();
    const auto ideal = idealCounts(faces, rays, points);
    const double idealError = rmsError(ideal, exact);
    const double error = rmsError(found, exact);
    EXPECT_NEAR(error, idealError, 0.02 * idealError);
    EXPECT_LT(error, 0.1);
    // Where they differ, single precision puts a crossing or the point on different sides of a
    // slice, of a column or of a leaf's edge.
    std::size_t differing = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < kClasses; ++k)
            differing += std::abs(found[i][k] - ideal[i][k]) > 1e-3 ? 1 : 0;
    EXPECT_LT(differing, kClasses * points.size() / 100);

    // Three slicemaps of a face, with ranges of each column in common.
    desc.localRanges = true;
    auto local = Transmittance::create(device(), desc).value();
    stats = local.prepare(lamp(), casters);
    ASSERT_TRUE(stats) << stats.error().text;
    EXPECT_LT(rmsError(probeCounts(local, points), exact), error);
}

} // namespace
} // namespace lamina
