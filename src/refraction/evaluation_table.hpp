#pragma once

#include <glm/gtc/type_precision.hpp>

#include <vector>

namespace lamina {

/// The evaluation table of [ED06] 3.3 for lamina/volume_integral.glsl: 256 x 256 texels, rows of
/// the back mask, columns of the front mask; laminaIntegralAddEntry() says what a texel holds.
[[nodiscard]] std::vector<glm::u8vec4> makeEvaluationTable();

} // namespace lamina
