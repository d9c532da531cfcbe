#pragma once

#include "gl/support/shadow_scene.hpp"

#include <string>
#include <vector>

namespace lamina::test {

struct RayComparison {
    double leastCompared = 0.6; ///< Share of the pixels that must be left to compare.
    double mostWrong = 0.0;     ///< Of the compared, that may differ.
};

/// Compares a picture of light (1 lit, 0 in shadow) with ray casting, and fails the test at pixels
/// that differ. Left out are pixels that their eight neighbours, or the same point brought nearer
/// by a pixel's width, do not agree with: edges of shadows and things, where subpixel precision and
/// the documented bias decide.
void expectRayCastShadow(const std::string& name, const std::vector<float>& found,
                         const SceneHost& host, const View& view, const glm::dvec4& light,
                         const RayComparison& comparison = {});

} // namespace lamina::test
