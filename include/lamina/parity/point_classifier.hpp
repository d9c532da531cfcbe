#pragma once

#include <lamina/core/export.hpp>
#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/parity/sprite_set.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lamina {

/// What is written for each point.
enum class PointAnswer : std::uint8_t {
    Bits,    ///< A bit, 1 inside: point i is bit i & 7 of byte i >> 3.
    Bytes,   ///< A byte: 0 outside, 1 inside.
    Classes, ///< A byte: 0 outside, 1 inside, 2 border (laminaParityClassify()).
    Masks,   ///< 32 bits: bit s is "inside sprite s"; PointQuery::rule does not apply.
};

/// One answer from several sprites.
enum class SpriteRule : std::uint8_t {
    Union,        ///< Inside any sprite.
    Intersection, ///< Inside all sprites.
    Difference,   ///< Inside the first and no other.
};

struct PointQuery {
    PointAnswer answer = PointAnswer::Bytes;
    SpriteRule rule = SpriteRule::Union;
    /// Sprites of one shape along different axes, that stand together in the set: s * directions
    /// and those after it are shape s, and masks have a bit per shape. Above 0:
    /// laminaParityInsideRefined(), which finds the inside near surfaces parallel to an axis; 3
    /// with sprites along spriteAxes() is as accurate as it gets.
    /// 0: laminaParityInside(), a sprite a shape. Not for Classes.
    std::uint32_t directions = 0;
};

/// Points in a GL buffer of the host: three floats each, world space. Single precision: keep world
/// coordinates local, see fitSprite().
struct PointBuffer {
    std::uint32_t buffer = 0;       ///< GL name.
    std::uint64_t offsetBytes = 0;  ///< Of point 0; a multiple of 4.
    std::uint32_t strideBytes = 12; ///< From one point to the next; a multiple of 4, at least 12.
    std::uint64_t count = 0;
};

/// Tests batches of points against the sprites of a set, on the GPU, by the functions that shaders
/// use. Points with a coordinate that is not a number are outside (of an inverted sprite: inside).
/// Move-only; see Device for threads and lifetime. Every call leaves the GL state as it was.
class LAMINA_API PointClassifier {
public:
    [[nodiscard]] static Result<PointClassifier> create(const Device& device);

    PointClassifier(PointClassifier&&) noexcept;
    PointClassifier& operator=(PointClassifier&&) noexcept;
    ~PointClassifier();

    /// Bytes of the answers to `count` points: whole 32-bit words.
    [[nodiscard]] static std::uint64_t answerBytes(PointAnswer answer, std::uint64_t count);

    /// Writes answerBytes() bytes to `answers` from byte `answerOffset` (a multiple of 4) on; bits
    /// past the last point are 0. Does not wait for the GPU.
    /// GL: points written by shaders need GL_SHADER_STORAGE_BARRIER_BIT before the call, and
    /// answers what their reader needs after it.
    /// Errors: InvalidArgument (values outside their enumerations, SpriteSet::outdatedSprite();
    /// buffers too small, misaligned or none; directions that do not divide the set, or with
    /// Classes), DeviceLimit (points further apart than a storage binding reaches), ShaderError.
    [[nodiscard]] Result<void> classify(const SpriteSet& sprites, const PointBuffer& points,
                                        const PointQuery& query, std::uint32_t answers,
                                        std::uint64_t answerOffset = 0);

    /// The same for points in host memory; the first answerBytes() bytes of the answers, little
    /// end first. Waits for the GPU. During the call 12 bytes a point and answerBytes() count
    /// against DeviceDesc::memoryBudgetBytes. Errors: as above, OutOfMemory.
    [[nodiscard]] Result<std::vector<std::uint8_t>> download(const SpriteSet& sprites,
                                                             std::span<const glm::vec3> points,
                                                             const PointQuery& query = {});

private:
    struct Impl;
    explicit PointClassifier(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> mImpl;
};

} // namespace lamina
