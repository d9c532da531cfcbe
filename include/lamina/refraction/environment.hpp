#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>

#include <cstdint>
#include <memory>

namespace lamina {

/// How the blurred levels of an environment are made.
enum class EnvironmentFilter : std::uint8_t {
    MipPyramid, ///< Means of 2 x 2 texels: fast, for environments that change every frame.
    /// Round Gaussians on the sphere: no squares and no face edges show in frosted glass. About 50
    /// look-ups a texel of all levels but the first.
    Gaussian,
};

struct EnvironmentDesc {
    std::uint32_t size = 256; ///< Texels a side of the cube map's level 0; a power of two.
    EnvironmentFilter filter = EnvironmentFilter::Gaussian;
};

/// Light from far away, by direction and blur: an HDR cube map with a pyramid of blurred levels,
/// copied from the host's. Directions are world directions, OpenGL's cube map convention.
/// Move-only; see Device for threads, lifetime and GL state.
class LAMINA_API Environment {
public:
    /// Black until a load. Errors: InvalidArgument (size), DeviceLimit, OutOfMemory, ShaderError.
    [[nodiscard]] static Result<Environment> create(const Device& device,
                                                    const EnvironmentDesc& desc = {});

    Environment(Environment&&) noexcept;
    Environment& operator=(Environment&&) noexcept;
    ~Environment();

    /// Copies a complete cube map of any float or normalized format and size; linear colours. Level
    /// 0 is read with the texture's own filter (mind aliasing if it is much larger than `size`).
    /// Errors: InvalidArgument (no cube map of this name; one of integers or depths, or
    /// that is incomplete); what it held stays. GL: writes of shaders need
    /// GL_TEXTURE_FETCH_BARRIER_BIT. Cost: a pass over the texels of every level.
    [[nodiscard]] Result<void> loadCubeMap(std::uint32_t texture);
    /// The same of a 2D texture in the equirectangular (latitude-longitude) projection: its rows
    /// run from straight down (-y) in row 0 to straight up in the last one, columns from +z over -x
    /// and -z, in the middle, and +x back to +z.
    [[nodiscard]] Result<void> loadEquirectangular(std::uint32_t texture);

    /// GL name of the cube map, GL_RGBA16F with all levels. A look-up at level L is blurred by a
    /// standard deviation of about 0.7 texels of that level.
    [[nodiscard]] std::uint32_t texture() const;
    [[nodiscard]] const EnvironmentDesc& desc() const;
    [[nodiscard]] std::uint32_t levels() const;
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t gpuBytes() const;

private:
    struct Impl;
    explicit Environment(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
