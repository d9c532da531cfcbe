#pragma once

#include "gl/device_state.hpp"

#include <lamina/voxelize/volume_grid.hpp>

#include <array>

namespace lamina {

/// Half-float sums of the payloads that a volume keeps in 8 bits, and how they become these.
class VolumeResolver {
public:
    explicit VolumeResolver(std::shared_ptr<gl::DeviceState> device)
        : mDevice(std::move(device)) {}

    /// Gets the programs and textures for a volume's layout and a grid's size ready.
    /// Errors: OutOfMemory, DeviceLimit, ShaderError; the textures are then as before.
    [[nodiscard]] Result<void> prepare(const VolumeLayout& layout, const GridTransform& transform);

    /// The texture that hits of a payload are added to: the volume's own unless it is resolved.
    [[nodiscard]] GLuint target(VolumePayload payload, const VolumeGrid& volume) const;

    /// Writes the volume's resolved payloads. Rebinds the program and image units 0 and 1; the
    /// caller issues the barrier.
    void resolve(const VolumeGrid& volume) const;

    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    std::array<gl::Texture, kVolumePayloadCount> mSums;
    std::array<GLuint, kVolumePayloadCount> mPrograms{};
    VolumeLayout mLayout;
    glm::uvec3 mSize{0};
};

} // namespace lamina
