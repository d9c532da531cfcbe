#pragma once

#include "gl/device_state.hpp"
#include "voxelize/triangle_capture.hpp"

#include <lamina/voxelize/geometry_source.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// Point samples of geometry, made on the GPU each frame: area-uniform, denser near a light.
class LAMINA_API PointSamples {
public:
    /// Errors: ShaderError.
    [[nodiscard]] static Result<PointSamples> create(std::shared_ptr<gl::DeviceState> device,
                                                     std::uint32_t points);

    /// Checks the sources and makes room for their triangles, as far as they say how many, and for
    /// the samples; before any work.
    /// Errors: InvalidArgument (unsound sources, an active transform feedback of the host),
    /// OutOfMemory, DeviceLimit (more triangles than a storage buffer holds), ShaderError.
    [[nodiscard]] Result<void> prepare(std::span<const GeometrySource> sources);
    /// Draws the samples, after prepare() of the same sources. middle: of the light; near: distance
    /// from it below which density does not grow; 0: no light, area alone.
    /// Errors: of a DrawSource that does not say how many triangles it has, as above.
    [[nodiscard]] Result<void> draw(std::span<const GeometrySource> sources,
                                    const glm::dvec3& middle, double near);

    [[nodiscard]] std::uint32_t count() const { return mCount; }
    [[nodiscard]] GLuint points() const { return mPoints.id(); }
    [[nodiscard]] GLuint triangles() const { return mTriangles.id(); }
    /// Bytes of GL memory held.
    [[nodiscard]] std::uint64_t bytes() const {
        return mCapture.bytes() + mTriangles.bytes() + mWeights.bytes() + mBlocks.bytes() +
               mPoints.bytes();
    }

private:
    PointSamples(std::shared_ptr<gl::DeviceState> device, std::uint32_t points);
    [[nodiscard]] Result<void> reserve(std::uint64_t blocks);
    void dispatch(GLuint program, const void* constants, GLuint captured, std::uint32_t groups);

    std::shared_ptr<gl::DeviceState> mDevice;
    std::uint32_t mCount;
    TriangleCapture mCapture;
    std::vector<GLuint> mCapturePrograms; ///< One a source.
    GLuint mWeighProgram = 0, mSumProgram = 0, mPointProgram = 0;
    gl::Buffer mConstants;
    gl::Buffer mTriangles, mWeights, mBlocks, mPoints;
};

} // namespace lamina
