#pragma once

#include "gl/glad.hpp"

#include <lamina/core/result.hpp>
#include <lamina/voxelize/volume_grid.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace lamina {

inline constexpr std::array kVolumePayloads = {VolumePayload::Count, VolumePayload::Absorption,
                                               VolumePayload::Normal, VolumePayload::Color,
                                               VolumePayload::Optics};

[[nodiscard]] constexpr std::size_t indexOf(VolumePayload payload) {
    return static_cast<std::size_t>(payload);
}

/// A VolumeFormat in GL's words.
struct VolumeFormatInfo {
    std::string_view name;
    GLenum internalFormat = GL_NONE;
    std::uint32_t bytesPerTexel = 0;
    std::uint32_t channels = 0;
};

[[nodiscard]] VolumeFormatInfo info(VolumeFormat format);

/// May the payload be stored like that? Errors: InvalidArgument.
[[nodiscard]] Result<void> checkLayout(const VolumeLayout& layout);

/// Is the texture filled from half-float sums instead of being drawn to?
[[nodiscard]] bool isResolved(VolumePayload payload, VolumeFormat format);

/// The format that hits are added up in: half floats for resolved payloads, else `format`.
[[nodiscard]] VolumeFormat accumulationFormat(VolumePayload payload, VolumeFormat format);

/// LAMINA_VOLUME_* bits of what the layout holds.
[[nodiscard]] std::uint32_t payloadBits(const VolumeLayout& layout);
/// LAMINA_VOLUME_* bits of the resolved payloads.
[[nodiscard]] std::uint32_t resolvedBits(const VolumeLayout& layout);

/// Hits of one voxel that every format of the layout counts exactly.
[[nodiscard]] std::uint64_t hitCeiling(const VolumeLayout& layout);

} // namespace lamina
