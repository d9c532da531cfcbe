#pragma once

#include <lamina/core/result.hpp>

#include <glm/vec2.hpp>

#include <functional>
#include <span>
#include <vector>

namespace lamina {

/// Places points of the unit square by the luminances of a picture on it.
class LuminanceTable {
public:
    struct Sample {
        glm::dvec2 place{0.0};
        double density = 1.0;   ///< Of points there; its mean over the square is 1.
        float luminance = 1.0f; ///< Of the picture there.
    };

    /// luminances: rows from v = 0; none: points are placed evenly. rowWeight: of a row at v, times
    /// its luminances. Errors: InvalidArgument (another number of luminances than size tells,
    /// negative or non-finite ones, all 0).
    [[nodiscard]] static Result<LuminanceTable>
    create(std::span<const float> luminances, const glm::uvec2& size,
           const std::function<double(double)>& rowWeight);

    /// uniform: in [0,1)^2.
    [[nodiscard]] Sample sample(const glm::dvec2& uniform) const;

private:
    glm::uvec2 mSize{0};
    std::vector<float> mLuminances;
    std::vector<double> mRows;    ///< Sums of weights up to and with each row.
    std::vector<double> mColumns; ///< The same within each row.
};

} // namespace lamina
