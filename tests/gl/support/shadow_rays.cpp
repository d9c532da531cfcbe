#include "gl/support/shadow_rays.hpp"

#include <reference/epipolar_rays.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace lamina::test {
namespace {

/// Light at the points that a view shows.
class LitRays {
public:
    LitRays(const SceneHost& host, const View& view, const glm::dvec4& lightAt)
        : mView(view)
        , mClipToWorld(glm::inverse(view.worldToClip))
        , mSeen(host.wholeMesh())
        , mCasters(host.casterMesh()) {
        mLight.kind = lightAt.w == 0.0 ? LightKind::Directional : LightKind::Point;
        mLight.position = glm::dvec3(lightAt);
        mLight.direction = -glm::dvec3(lightAt);
    }

    /// lift: how much nearer, in pixel widths.
    [[nodiscard]] bool lit(const glm::dvec2& pixel, double lift) const {
        const auto [origin, along] = ray(pixel);
        const double t = mSeen.firstHit(origin, along);
        if (std::isinf(t))
            return true;
        const glm::dvec3 point = origin + along * t;
        const glm::dvec4 clip = mView.worldToClip * glm::dvec4(point, 1.0);
        const double least = mView.clipDepth == ClipDepth::ZeroToOne ? 0.0 : -1.0;
        if (clip.z > clip.w || clip.z < least * clip.w)
            return true;
        const auto [nextOrigin, nextAlong] = ray(pixel + glm::dvec2(1.0, 0.0));
        const double width = glm::distance(nextOrigin + nextAlong * t, point);
        // Off the surface at least by what rays in single precision need.
        const double back = std::max(2e-4, lift * width);
        return mCasters.lit(mLight, point - back * glm::normalize(along));
    }

private:
    struct Ray {
        glm::dvec3 origin, along;
    };

    [[nodiscard]] Ray ray(const glm::dvec2& pixel) const {
        const glm::dvec2 at = pixel / glm::dvec2(mView.size) * 2.0 - 1.0;
        const auto unproject = [&](double depth) {
            const glm::dvec4 p = mClipToWorld * glm::dvec4(at, depth, 1.0);
            return glm::dvec3(p) / p.w;
        };
        const bool growsWithDistance = mView.backgroundDepth > 0.5f;
        const double least = mView.clipDepth == ClipDepth::ZeroToOne ? 0.0 : -1.0;
        const bool isFlipped = growsWithDistance != (mView.depthRange.x < mView.depthRange.y);
        const glm::dvec3 near = unproject(isFlipped ? 1.0 : least);
        return {near, unproject(0.5) - near};
    }

    const View& mView;
    glm::dmat4 mClipToWorld;
    reference::ShadowRays mSeen, mCasters;
    EpipolarLight mLight;
};

} // namespace

void expectRayCastShadow(const std::string& name, const std::vector<float>& found,
                         const SceneHost& host, const View& view, const glm::dvec4& light,
                         const RayComparison& comparison) {
    const LitRays rays(host, view, light);
    const glm::uvec2 size = view.size;
    std::vector<float> expected(found.size());
    std::vector<float> lifted(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        const glm::dvec2 pixel(static_cast<double>(i % size.x) + 0.5,
                               static_cast<double>(i / size.x) + 0.5);
        expected[i] = rays.lit(pixel, 0.0) ? 1.0f : 0.0f;
        lifted[i] = rays.lit(pixel, 1.0) ? 1.0f : 0.0f;
    }
    std::size_t compared = 0;
    std::size_t wrong = 0;
    std::size_t shadowed = 0;
    for (std::uint32_t y = 1; y + 1 < size.y; ++y)
        for (std::uint32_t x = 1; x + 1 < size.x; ++x) {
            const std::size_t i = std::size_t{y} * size.x + x;
            bool isSettled = lifted[i] == expected[i];
            for (const std::uint32_t row : {y - 1, y, y + 1})
                for (const std::uint32_t column : {x - 1, x, x + 1})
                    isSettled =
                        isSettled && expected[std::size_t{row} * size.x + column] == expected[i];
            if (!isSettled)
                continue;
            ++compared;
            shadowed += expected[i] == 0.0f ? 1 : 0;
            wrong += found[i] != expected[i] ? 1 : 0;
        }
    savePicture(name + "_found", found, size, 1.0f);
    savePicture(name + "_rays", expected, size, 1.0f);
    const auto pixels = static_cast<double>(found.size());
    EXPECT_GT(static_cast<double>(compared), comparison.leastCompared * pixels) << name;
    EXPECT_GT(static_cast<double>(shadowed), 0.004 * pixels) << name;
    EXPECT_LE(static_cast<double>(wrong), comparison.mostWrong * static_cast<double>(compared))
        << name << ", of " << compared << " pixels";
}

} // namespace lamina::test
