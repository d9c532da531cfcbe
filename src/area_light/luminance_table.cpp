#include "area_light/luminance_table.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {
namespace {

/// Index of the interval of `sums` that holds `at`, and where in it, in [0,1).
std::pair<std::size_t, double> find(std::span<const double> sums, double at) {
    const double wanted = at * sums.back();
    const auto found = std::ranges::upper_bound(sums, wanted);
    const auto index =
        std::min<std::size_t>(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1);
    const double before = index == 0 ? 0.0 : sums[index - 1];
    const double width = sums[index] - before;
    return {index, width > 0.0 ? std::clamp((wanted - before) / width, 0.0, 1.0) : 0.5};
}

} // namespace

Result<LuminanceTable> LuminanceTable::create(std::span<const float> luminances,
                                              const glm::uvec2& size,
                                              const std::function<double(double)>& rowWeight) {
    LuminanceTable table;
    if (luminances.empty())
        return table;
    if (std::uint64_t{size.x} * size.y != luminances.size())
        return Error{ErrorCode::InvalidArgument,
                     "virtual lights: expected " + std::to_string(size.x) + " x " +
                         std::to_string(size.y) + " luminances, found " +
                         std::to_string(luminances.size())};
    double whole = 0.0;
    for (std::uint32_t y = 0; y < size.y; ++y) {
        const double weight = rowWeight((y + 0.5) / size.y);
        double row = 0.0;
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const float value = luminances[std::size_t{y} * size.x + x];
            if (!std::isfinite(value) || value < 0.0f)
                return Error{ErrorCode::InvalidArgument,
                             "virtual lights: expected finite luminances of at least 0, found " +
                                 std::to_string(value)};
            row += weight * value;
            table.mColumns.push_back(row);
        }
        whole += row;
        table.mRows.push_back(whole);
    }
    if (!(whole > 0.0))
        return Error{ErrorCode::InvalidArgument,
                     "virtual lights: expected a luminance above 0, found none"};
    table.mSize = size;
    table.mLuminances.assign(luminances.begin(), luminances.end());
    return table;
}

LuminanceTable::Sample LuminanceTable::sample(const glm::dvec2& uniform) const {
    if (mLuminances.empty())
        return {uniform, 1.0, 1.0f};
    const auto [y, v] = find(mRows, uniform.y);
    const std::span<const double> row(mColumns.data() + y * mSize.x, mSize.x);
    const auto [x, u] = find(row, uniform.x);
    const double weight = row[x] - (x == 0 ? 0.0 : row[x - 1]);
    const double cells = static_cast<double>(mSize.x) * mSize.y;
    return {
        glm::dvec2((static_cast<double>(x) + u) / mSize.x, (static_cast<double>(y) + v) / mSize.y),
        weight * cells / mRows.back(), mLuminances[y * mSize.x + x]};
}

} // namespace lamina
