#pragma once

#include "gl/device_state.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <cstddef>

namespace lamina {

/// Checks the normals and colours of a MeshView against their buffers and the device. `index`: of
/// the source in the call, for the error's text.
[[nodiscard]] Result<void> checkMeshAttributes(const gl::DeviceState& device, const MeshView& view,
                                               std::size_t index);

/// A vertex array for drawMeshView() whose shader also reads normals and colours.
[[nodiscard]] gl::VertexArray createAttributeArray(const std::shared_ptr<gl::DeviceState>& device);

/// Points a vertex array of createAttributeArray() at the view's normals and colours. Attributes
/// that the view lacks read a zero normal, or white.
void bindMeshAttributes(gl::DeviceState& device, GLuint vertexArray, GLuint defaults,
                        const MeshView& view);

/// What vertices without normals or colours read: the buffer for bindMeshAttributes().
[[nodiscard]] Result<gl::Buffer>
createDefaultAttributes(const std::shared_ptr<gl::DeviceState>& device);

} // namespace lamina
