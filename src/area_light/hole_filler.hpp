#pragma once

#include "gl/device_state.hpp"

#include <lamina/core/result.hpp>

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace lamina {

/// Fills holes of imperfect shadow maps: a pyramid is pulled up from all maps at once and pushed
/// down into their empty texels ([WD13] 3.1.2).
class LAMINA_API HoleFiller {
public:
    /// side: texels of a square map. levels: of the pyramid above it; 0 fills nothing.
    /// Errors: ShaderError.
    [[nodiscard]] static Result<HoleFiller> create(std::shared_ptr<gl::DeviceState> device,
                                                   std::uint32_t side, std::uint32_t levels);

    /// Texels of a layer: the map at (0, 0), its pyramid to the right of it.
    [[nodiscard]] glm::uvec2 layerSize() const;

    /// texture: R32F array of layers of layerSize(); the first `maps` are filled. Empty texels hold
    /// LAMINA_SPLAT_EMPTY. Makes the result visible to texture fetches and image access.
    void fill(GLuint texture, std::uint32_t maps) const;

private:
    explicit HoleFiller(std::shared_ptr<gl::DeviceState> device);

    /// Where a level of the pyramid is.
    struct Level {
        std::uint32_t side = 0;
        glm::uvec2 first{0};
    };
    std::shared_ptr<gl::DeviceState> mDevice;
    std::vector<Level> mLevels; ///< The map first.
    GLuint mPullProgram = 0, mPushProgram = 0;
    gl::Buffer mConstants;
};

} // namespace lamina
