#pragma once

#include "gl/device_state.hpp"

#include <lamina/grid/grid_transform.hpp>
#include <lamina/parity/depth_sprite.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace lamina::detail {

struct DepthSpriteData {
    std::shared_ptr<gl::DeviceState> device;
    gl::Texture texture;
    gl::Buffer report; ///< shared::LaminaSpriteReport
    std::uint32_t layers = 0;
    std::optional<GridTransform> transform;
    /// Ends when columns, layers or transform change, and with the sprite: sets that hold it weakly
    /// see that what they know of the sprite no longer holds.
    std::shared_ptr<const char> placement;

    /// A texture for that many columns and layers, or nothing if the present one has them.
    /// Errors: DeviceLimit, OutOfMemory.
    [[nodiscard]] Result<gl::Texture> allocate(const GridTransform& wanted,
                                               std::uint32_t wantedLayers) const;
};

/// Waits for the GPU.
[[nodiscard]] SpriteReport downloadReport(const gl::DeviceState& device, const gl::Buffer& report);

/// A buffer for a report. Errors: OutOfMemory.
[[nodiscard]] Result<gl::Buffer> createReportBuffer(const std::shared_ptr<gl::DeviceState>& device);

} // namespace lamina::detail
