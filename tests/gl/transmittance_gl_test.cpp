// The numbers of lamina/transmittance.glsl on scenes whose answers are known.

#include "gl/support/transmittance_probe.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <reference/shapes.hpp>

#include <cmath>
#include <random>

namespace lamina {
namespace {

using test::kRounding;
using test::kSigma;

class TransmittanceQuadsGlTest : public test::TransmittanceGlTest {
protected:
    /// `count` quads of 4 x 4 units facing the sun, at z = -1, -2, ..., as the sun at +z sees them.
    void addQuads(unsigned count, std::uint32_t materialId = 0, float first = -1.0f,
                  float spacing = -1.0f) {
        mMeshes.push_back(
            MeshBuffers::upload(
                device(), reference::makeParallelQuads({0.0f, 0.0f, first}, 4.0f, count, spacing))
                .value());
        MeshView view = mMeshes.back().view();
        view.materialId = materialId;
        mSources.emplace_back(view);
    }

    TransmittanceCasters casters() const {
        TransmittanceCasters casters;
        casters.leaves = mSources;
        casters.bounds = {{-2.0, -2.0, -20.0}, {2.0, 2.0, 0.0}};
        return casters;
    }

    static TransmittanceLight sun() {
        TransmittanceLight light;
        light.direction = {0.0, 0.0, -2.0};
        return light;
    }

    Transmittance make(const TransmittanceDesc& desc) {
        return Transmittance::create(device(), desc).value();
    }

    static TransmittanceDesc descOf(std::uint32_t slices, bool local) {
        TransmittanceDesc desc;
        desc.size = {16, 16, slices};
        desc.localRanges = local;
        return desc;
    }

    std::vector<MeshBuffers> mMeshes;
    std::vector<GeometrySource> mSources;
};

TEST_F(TransmittanceQuadsGlTest, StackOfQuadsIsCountedExactly) {
    addQuads(15);
    std::vector<test::ProbePoint> points;
    for (int n = 0; n <= 15; ++n)
        for (const double x : {-1.7, 0.03, 1.7})
            points.push_back({{x, 0.4, -n - 0.6}, {0.3, 0.2, 1.0}});
    for (const bool local : {false, true})
        for (const std::uint32_t slices : {160u, 512u, 1024u}) {
            SCOPED_TRACE(std::to_string(slices) + (local ? " local" : " uniform"));
            Transmittance transmittance = make(descOf(slices, local));
            ASSERT_TRUE(transmittance.prepare(sun(), casters()));
            for (const TransmittanceSettings& settings : {plain(kSigma), attenuating(kSigma)}) {
                ASSERT_TRUE(transmittance.setSettings(settings));
                const auto found = probe(transmittance, points);
                for (std::size_t i = 0; i < points.size(); ++i)
                    EXPECT_NEAR(found[i].x, std::pow(1.0 - kSigma, i / 3), kRounding) << i;
            }
        }
    // The last leaf of a local range does not count before itself.
    Transmittance local = make(descOf(128, true));
    ASSERT_TRUE(local.prepare(sun(), casters()));
    ASSERT_TRUE(local.setSettings(plain(kSigma)));
    const test::ProbePoint last[] = {{{0.03, 0.4, -15.0}}};
    EXPECT_NEAR(probe(local, last).front().x, std::pow(1.0 - kSigma, 14), kRounding);
    // 32 slices: every second one holds a quad.
    Transmittance transmittance = make(descOf(32, false));
    TransmittanceCasters tight = casters();
    tight.bounds = {{-2.0, -2.0, -16.25}, {2.0, 2.0, -0.25}};
    ASSERT_TRUE(transmittance.prepare(sun(), tight));
    ASSERT_TRUE(transmittance.setSettings(plain(kSigma)));
    const auto found = probe(transmittance, points);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(found[i].x, std::pow(1.0 - kSigma, i / 3), kRounding) << i;
}

TEST_F(TransmittanceQuadsGlTest, PointsWithoutLeavesBeforeThemAreLit) {
    addQuads(3);
    const test::ProbePoint lit[] = {{{0, 0, -0.5}}, {{0, 0, 50}},    {{0, 0, -1.0 + 1e-3}},
                                    {{5, 0, -9}},   {{0, -2.5, -9}}, {{2.01, 2.01, -2.5}}};
    for (const bool local : {false, true}) {
        Transmittance transmittance = make(descOf(128, local));
        ASSERT_TRUE(transmittance.prepare(sun(), casters()));
        for (const glm::vec3& value : probe(transmittance, lit))
            EXPECT_EQ(value, glm::vec3(1.0f));
        ASSERT_TRUE(transmittance.prepare(
            sun(), {.leaves = {}, .opaque = {}, .materials = {}, .bounds = casters().bounds}));
        const test::ProbePoint behind[] = {{{0, 0, -9}}};
        EXPECT_EQ(probe(transmittance, behind).front(), glm::vec3(1.0f));
    }
}

TEST_F(TransmittanceQuadsGlTest, AttenuationChangesWithoutNewMaps) {
    addQuads(2);
    Transmittance transmittance = make(descOf(128, false));
    ASSERT_TRUE(transmittance.prepare(sun(), casters()));
    const test::ProbePoint behind[] = {{{0, 0, -5}}};
    for (const glm::vec3& sigma : {glm::vec3(0.0f, 0.5f, 1.0f), glm::vec3(0.3f, 0.05f, 0.9f)}) {
        TransmittanceSettings settings;
        settings.attenuation.fill(sigma);
        ASSERT_TRUE(transmittance.setSettings(settings));
        const glm::vec3 found = probe(transmittance, behind).front();
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(found[channel], (1.0 - sigma[channel]) * (1.0 - sigma[channel]), kRounding);
    }
}

TEST_F(TransmittanceQuadsGlTest, EachClassHasItsColour) {
    addQuads(2, 0, -1.0f, -3.0f);
    addQuads(3, 1, -2.0f, -3.0f);
    addQuads(1, 2, -3.0f, -3.0f);
    std::vector<Material> materials(3);
    materials[0].colorClass = 2;
    materials[2].colorClass = 1;
    TransmittanceSettings settings = plain(0.0f);
    settings.attenuation[0] = {0.1f, 0.2f, 0.3f};
    settings.attenuation[1] = {0.0f, 0.5f, 0.7f};
    settings.attenuation[2] = {0.6f, 0.4f, 0.0f};
    for (const bool local : {false, true}) {
        TransmittanceDesc desc = descOf(128, local);
        desc.classes = 3;
        Transmittance transmittance = make(desc);
        TransmittanceCasters all = casters();
        all.materials = materials;
        const auto stats = transmittance.prepare(sun(), all);
        ASSERT_TRUE(stats) << stats.error().text;
        EXPECT_EQ(stats->passes, local ? 2u : 1u);
        for (const SliceLookup lookup : {SliceLookup::Sampled, SliceLookup::Linear}) {
            settings.slices = lookup;
            ASSERT_TRUE(transmittance.setSettings(settings));
            const test::ProbePoint points[] = {
                {{0, 0, -1.85}}, {{0, 0, -2.85}}, {{0, 0, -3.85}}, {{0, 0, -12}}};
            const int counts[][3] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {3, 1, 2}};
            const auto found = probe(transmittance, points);
            for (int i = 0; i < 4; ++i)
                for (int channel = 0; channel < 3; ++channel) {
                    double expected = 1.0;
                    for (std::size_t c = 0; c < 3; ++c)
                        expected *= std::pow(1.0 - settings.attenuation[c][channel], counts[i][c]);
                    EXPECT_NEAR(found[static_cast<std::size_t>(i)][channel], expected, kRounding)
                        << i << ' ' << channel;
                }
        }
    }
}

TEST_F(TransmittanceQuadsGlTest, AbsorptionSumsUp) {
    addQuads(2, 0, -1.0f, -2.0f);
    addQuads(2, 1, -2.0f, -2.0f);
    std::vector<Material> materials(2);
    materials[0].absorption = 0.125f;
    materials[1].absorption = 0.25f;
    TransmittanceDesc desc = descOf(200, false);
    desc.model = TransmittanceModel::Absorption;
    Transmittance transmittance = make(desc);
    TransmittanceCasters all = casters();
    all.materials = materials;
    const auto stats = transmittance.prepare(sun(), all);
    ASSERT_TRUE(stats) << stats.error().text;
    std::vector<test::ProbePoint> points;
    for (int n = 0; n <= 4; ++n)
        points.push_back({{0.1, 0.2, -n - 0.6}});
    points.push_back({{0.0, 0.0, -40.0}});
    points.push_back({{3.0, 0.0, -40.0}});
    constexpr double kSums[] = {0.0, 0.125, 0.375, 0.5, 0.75, 0.75, 0.0};
    for (const AbsorptionForm form : {AbsorptionForm::Exponential, AbsorptionForm::Linear})
        for (const SliceLookup slices : {SliceLookup::Sampled, SliceLookup::Linear})
            for (const float scale : {1.0f, 2.0f}) {
                TransmittanceSettings settings;
                settings.slices = slices;
                settings.absorptionForm = form;
                settings.absorptionScale = scale;
                ASSERT_TRUE(transmittance.setSettings(settings));
                const auto found = probe(transmittance, points);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const double sum = scale * kSums[i];
                    const double expected = form == AbsorptionForm::Exponential
                                                ? std::exp(-sum)
                                                : std::max(0.0, 1.0 - sum);
                    EXPECT_NEAR(found[i].y, expected, kRounding) << i;
                }
            }
}

TEST_F(TransmittanceQuadsGlTest, OpaqueCastersDecideFirst) {
    addQuads(4);
    const auto wall =
        MeshBuffers::upload(device(), reference::makePlane({-1.0f, 0.0f, -2.5f}, {0, 0, 1}, 2.0f))
            .value();
    const GeometrySource opaque[] = {wall.view()};
    TransmittanceCasters all = casters();
    all.opaque = opaque;
    Transmittance transmittance = make(descOf(128, false));
    ASSERT_TRUE(transmittance.prepare(sun(), all));
    ASSERT_TRUE(transmittance.setSettings(plain(kSigma)));
    const test::ProbePoint points[] = {{{-1, 0, -2.4}}, {{-1, 0, -2.6}}, {{-1, 0, -9}},
                                       {{1, 0, -9}},    {{-1, 1.5, -9}}, {{-1, 0, -2.5}}};
    const double expected[] = {std::pow(0.75, 2), 0.0, 0.0, std::pow(0.75, 4), std::pow(0.75, 4)};
    const auto found = probe(transmittance, points);
    for (std::size_t i = 0; i < std::size(expected); ++i)
        EXPECT_NEAR(found[i].x, expected[i], kRounding) << i;
    // The lit side of the wall itself, with the default bias.
    ASSERT_TRUE(transmittance.setSettings(attenuating(0.0f)));
    EXPECT_EQ(probe(transmittance, points).back(), glm::vec3(1.0f));

    all.opaque = {};
    ASSERT_TRUE(transmittance.prepare(sun(), all));
    EXPECT_EQ(probe(transmittance, points)[2], glm::vec3(1.0f));
}

TEST_F(TransmittanceQuadsGlTest, OpaqueFilterAveragesLitTexels) {
    // A leaf over all, and an opaque wall where x < 0: its edge lies between two texels of the map.
    addQuads(1);
    const auto wall =
        MeshBuffers::upload(device(), reference::makePlane({-1.0f, 0.0f, -5.0f}, {0, 0, 1}, 2.0f))
            .value();
    const GeometrySource opaque[] = {wall.view(glm::scale(glm::mat4(1.0f), {1.0f, 2.0f, 1.0f}))};
    TransmittanceCasters all = casters();
    all.opaque = opaque;
    TransmittanceDesc desc = descOf(128, false);
    desc.opaqueMapTexels = 64;
    Transmittance transmittance = make(desc);
    ASSERT_TRUE(transmittance.prepare(sun(), all));
    std::vector<test::ProbePoint> points;
    for (int i = 0; i < 100; ++i)
        points.push_back({{-0.6 + 0.0117 * i, 0.1, -9.0}});
    for (const float width : {0.0f, 1.0f, 2.0f, 7.0f}) {
        TransmittanceSettings settings = plain(kSigma);
        settings.opaqueFilterWidth = width;
        ASSERT_TRUE(transmittance.setSettings(settings));
        const auto found = probe(transmittance, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double texels = points[i].position.x * 64.0 / 4.0;
            const double share = width == 0.0f ? (texels > 0.0 ? 1.0 : 0.0)
                                               : std::clamp(0.5 + texels / width, 0.0, 1.0);
            EXPECT_NEAR(found[i].x, share * (1.0 - kSigma), 1e-4) << width << ' ' << i;
        }
    }
}

TEST_F(TransmittanceQuadsGlTest, LeavesFromTheHostsVertexStage) {
    DrawSource source;
    source.vertexShader = R"(
LaminaVertex laminaVertex() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    return LaminaVertex(vec3(2.0 * corner, -1.0 - float(gl_InstanceID)), vec3(0.0, 0.0, 1.0),
                        uint(gl_InstanceID & 1));
}
)";
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    source.draw = [&](const DrawContext&) {
        gl().BindVertexArray(vertexArray);
        gl().DrawArraysInstanced(GL_TRIANGLES, 0, 3, 5);
    };
    std::vector<Material> materials(2);
    materials[1].colorClass = 1;
    materials[0].absorption = materials[1].absorption = 0.5f;
    const GeometrySource sources[] = {source};
    TransmittanceCasters all = casters();
    all.leaves = sources;
    all.materials = materials;
    const test::ProbePoint behind[] = {{{-0.5, -0.5, -18.0}}, {{-0.5, -0.5, -2.5}}};
    TransmittanceDesc desc = descOf(128, true);
    desc.classes = 2;
    Transmittance counting = make(desc);
    ASSERT_TRUE(counting.prepare(sun(), all));
    TransmittanceSettings settings = plain(0.0f);
    settings.attenuation[0] = glm::vec3(0.5f);
    settings.attenuation[1] = glm::vec3(0.1f);
    ASSERT_TRUE(counting.setSettings(settings));
    auto found = probe(counting, behind);
    EXPECT_NEAR(found[0].x, 0.125 * 0.81, kRounding);
    EXPECT_NEAR(found[1].x, 0.5 * 0.9, kRounding);
    desc = descOf(128, false);
    desc.model = TransmittanceModel::Absorption;
    Transmittance absorbing = make(desc);
    ASSERT_TRUE(absorbing.prepare(sun(), all));
    ASSERT_TRUE(absorbing.setSettings(plain(0.0f)));
    found = probe(absorbing, behind);
    EXPECT_NEAR(found[0].x, std::exp(-2.5), kRounding);
    EXPECT_NEAR(found[1].x, std::exp(-1.0), kRounding);
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(TransmittanceQuadsGlTest, MovingPointsSeeNoSteps) {
    addQuads(3, 0, -5.0f, -0.4f);
    Transmittance transmittance = make(descOf(128, false));
    ASSERT_TRUE(transmittance.prepare(sun(), casters()));
    ASSERT_TRUE(transmittance.setSettings(attenuating(kSigma)));
    constexpr int kSteps = 4000;
    std::vector<test::ProbePoint> points;
    for (int i = 0; i < kSteps; ++i)
        points.push_back({{0.2, 0.1, -4.0 - 4.0 * i / kSteps}});
    const auto found = probe(transmittance, points);
    // A step is 1/156 of a slice, in which the count changes by at most 1.5 / 156.
    const double most = -std::log(1.0 - kSigma) * 1.5 * (4.0 / kSteps) / (20.0 / 128) * 1.05;
    EXPECT_EQ(found.front().x, 1.0f);
    EXPECT_NEAR(found.back().x, std::pow(1.0 - kSigma, 3), kRounding);
    for (std::size_t i = 1; i < found.size(); ++i)
        EXPECT_LT(std::abs(found[i].x - found[i - 1].x), most + kRounding) << i;
}

TEST_F(TransmittanceQuadsGlTest, FilterAveragesCounts) {
    // A leaf that covers columns 0 to 7 of 16.
    mMeshes.push_back(
        MeshBuffers::upload(device(), reference::makePlane({-1.0f, 0.0f, -5.0f}, {0, 0, 1}, 2.0f))
            .value());
    mSources.emplace_back(mMeshes.back().view(glm::scale(glm::mat4(1.0f), {1.0f, 2.0f, 1.0f})));
    Transmittance transmittance = make(descOf(128, false));
    ASSERT_TRUE(transmittance.prepare(sun(), casters()));
    std::vector<test::ProbePoint> points;
    for (int i = 0; i < 100; ++i)
        points.push_back({{-1.9 + 0.038 * i, 0.1, -9.0}});
    for (const float width : {0.0f, 1.0f, 2.5f, 7.0f}) {
        TransmittanceSettings settings = attenuating(kSigma);
        settings.filterWidth = width;
        ASSERT_TRUE(transmittance.setSettings(settings));
        const auto found = probe(transmittance, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            // The sun's grid looks along -z: its columns' x runs along the world's or against it.
            const double edge = 4.0 * std::abs(points[i].position.x);
            const double near = points[i].position.x < 0.0 ? edge : -edge;
            double share =
                width == 0.0f ? (near > 0.0 ? 1.0 : 0.0) : std::clamp(0.5 + near / width, 0.0, 1.0);
            // Nothing covers what lies beyond the grid.
            if (width > 0.0f)
                share -= std::max(0.0, (4.0 * -points[i].position.x + 0.5 * width - 8.0) / width);
            EXPECT_NEAR(found[i].x, std::pow(1.0 - kSigma, share), 1e-4) << width << ' ' << i;
        }
    }
}

TEST_F(TransmittanceQuadsGlTest, LeavesDoNotShadowThemselves) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const double tilt : {0.0, 0.2, 0.7, 1.2, 1.5})
        for (const bool local : {false, true}) {
            SCOPED_TRACE(tilt);
            const glm::dvec3 normal(std::sin(tilt), 0.3 * std::sin(tilt), std::cos(tilt));
            const auto leaf =
                MeshBuffers::upload(
                    device(), reference::makePlane({0, 0, -10.0f}, glm::vec3(normal), 3.0f, 4))
                    .value();
            const GeometrySource sources[] = {leaf.view()};
            const glm::dvec3 u = glm::normalize(glm::cross(normal, glm::dvec3(0, 1, 0.2)));
            const glm::dvec3 v = glm::normalize(glm::cross(normal, u));
            std::vector<test::ProbePoint> points;
            for (int i = 0; i < 3000; ++i)
                points.push_back({glm::dvec3(0, 0, -10) + unit(random) * u + unit(random) * v,
                                  i % 2 == 0 ? normal : -normal});
            for (const std::uint32_t slices : {32u, 128u, 1024u}) {
                TransmittanceDesc desc = descOf(slices, local);
                desc.size.x = desc.size.y = 64;
                Transmittance transmittance = make(desc);
                TransmittanceCasters all = casters();
                all.leaves = sources;
                all.opaque = sources;
                ASSERT_TRUE(transmittance.prepare(sun(), all));
                for (const SliceLookup lookup : {SliceLookup::Sampled, SliceLookup::Linear}) {
                    TransmittanceSettings settings = attenuating(kSigma);
                    settings.slices = lookup;
                    ASSERT_TRUE(transmittance.setSettings(settings));
                    std::size_t dark = 0;
                    for (const glm::vec3& value : probe(transmittance, points))
                        dark += value.x < 1.0f ? 1 : 0;
                    EXPECT_EQ(dark, 0u)
                        << slices << (local ? " local " : " uniform ") << static_cast<int>(lookup);
                }
            }
        }
}

} // namespace
} // namespace lamina
