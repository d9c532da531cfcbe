#pragma once

#include "gl/device_state.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <cstddef>
#include <string_view>

namespace lamina {

/// Checks a MeshView against its buffers and the device. `index`: of the source in the call, for
/// the error's text, as is `what`: the operation and what a source is to it.
[[nodiscard]] LAMINA_API Result<void> checkMeshView(const gl::DeviceState& device,
                                                    const MeshView& view, std::size_t index,
                                                    std::string_view what = "voxelize: source");

/// Checks that a DrawSource has a vertex stage and a callback. `index`, `what`: as above.
[[nodiscard]] LAMINA_API Result<void> checkDrawSource(const DrawSource& source, std::size_t index,
                                                      std::string_view what = "voxelize: source");

/// offset + bytes, at most the largest number: an offset near it must not wrap around.
[[nodiscard]] std::uint64_t endOfRange(std::uint64_t offset, std::uint64_t bytes);

/// Triangles a MeshView draws.
[[nodiscard]] LAMINA_API std::uint64_t triangleCount(const MeshView& view);

/// Points `vertexArray` at the view's buffers (no binding changes) and draws the view with the
/// vertex array, which must be bound.
LAMINA_API void drawMeshView(gl::DeviceState& device, GLuint vertexArray, const MeshView& view);

} // namespace lamina
