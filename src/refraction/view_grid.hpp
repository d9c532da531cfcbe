#pragma once

#include <lamina/core/box.hpp>
#include <lamina/gl/view.hpp>
#include <lamina/grid/grid_transform.hpp>

#include <cstdint>
#include <string_view>

namespace lamina {

/// The grid whose columns are the pixels of `view` and whose depths enclose `bounds`.
/// Errors: InvalidArgument (those of viewpoint(), a window without right angles, oblique
/// orthographic rays, empty or non-finite bounds), prefixed by `operation`.
[[nodiscard]] Result<GridTransform> makeViewGrid(const View& view, const Box3& bounds,
                                                 std::uint32_t slices, std::string_view operation);

} // namespace lamina
