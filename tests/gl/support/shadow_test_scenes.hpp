#pragma once

#include "gl/support/gl_test.hpp"
#include "gl/support/shadow_scene.hpp"

#include <functional>
#include <vector>

namespace lamina::test {

/// A flat floor in y = 0 that does not cast.
[[nodiscard]] ScenePart floorPart();

/// Ten scenes of closed, open, thin, nested and chaotic casters on a floor in y = 0, about 7 units
/// wide, in which camera and lights move.
class ShadowScenesGlTest : public GlTest {
protected:
    using Check = std::function<void(const ShadowScene&)>;

    static constexpr glm::uvec2 kSize{128, 96};

    static ShadowScene sceneOf(SceneHost& host, const View& view, const glm::dvec4& light);
    std::vector<float> lightOf(ShadowVolumes& volumes, VolumeExtent extent) {
        return readRed(gl(), volumes.apply(extent).value(), kSize);
    }
    static std::size_t differences(const std::vector<float>& a, const std::vector<float>& b);

    /// Calls `check` for the sun and a lamp, in the first `steps` steps of their way and the
    /// camera's, 3 at most. everyScene: 1 for all of them, 2 for every second.
    void forAll(unsigned steps, const Check& check, std::size_t everyScene = 1);
    /// The same with the viewer in the casters' shadow volumes, near planes close and far: they
    /// cut volumes and casters. Scenes of next to no shadow are left out; returns how many views
    /// were found.
    unsigned forAllInShadow(const Check& check);
};

} // namespace lamina::test
