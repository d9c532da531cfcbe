#pragma once

#include "gl/support/gl_test.hpp"
#include "gl/support/host_draw.hpp"

#include <lamina/refraction/refraction.hpp>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <optional>
#include <span>
#include <vector>

namespace lamina::test {

inline constexpr glm::uvec2 kSize{64, 48};
inline constexpr RefractionModel kRefractionModels[] = {
    RefractionModel::VolumeIntegral, RefractionModel::TwoSurfaces, RefractionModel::ManySurfaces};

struct Ball {
    glm::dvec3 center;
    double radius;
};

/// What the pixel of a ball shows.
struct BallHit {
    std::size_t ball = 0;
    double distance = 0.0, chord = 0.0;
    glm::dvec3 normal{0.0};
};

/// A frame of kSize pixels in which a host has drawn balls: by formula, pixel by pixel.
class BallFrameTest : public GlTest {
protected:
    void SetUp() override;

    [[nodiscard]] glm::dvec3 ray(unsigned x, unsigned y) const;
    [[nodiscard]] std::optional<BallHit> hitBalls(std::span<const Ball> balls, unsigned x,
                                                  unsigned y) const;

    template<class Texel>
    gl::Texture texture(GLenum internal, GLenum format, GLenum type,
                        const std::vector<Texel>& texels, const glm::uvec2& size = kSize) {
        auto texture = makeTexture(device(), internal, size);
        gl().TextureSubImage2D(texture.id(), 0, 0, 0, static_cast<GLsizei>(size.x),
                               static_cast<GLsizei>(size.y), format, type, texels.data());
        return texture;
    }

    /// Depths, normals and the numbers (from 1) of balls.
    struct GBuffer {
        gl::Texture depth, normals, objects;
    };
    GBuffer draw(std::span<const Ball> balls);
    /// object 0: all of them.
    RefractionReceiver receiverOf(const GBuffer& drawn, std::uint32_t object = 0) const;
    std::vector<glm::vec4> read(GLuint texture);

    /// Surroundings from a cube map of f(direction).
    template<class Function>
    Environment environmentOf(Function f, const EnvironmentDesc& desc) {
        std::vector<glm::vec4> texels;
        for (std::size_t i = 0; i < std::size_t{6} * desc.size * desc.size; ++i)
            texels.emplace_back(f(cubeDirection(i, desc.size)), 1.0f);
        return environmentOf(texels, desc);
    }
    Environment whiteEnvironment() {
        return environmentOf([](const glm::vec3&) { return glm::vec3(1.0f); }, {.size = 8});
    }
    /// Direction of a cube map's texel, OpenGL 4.5, table 8.19.
    [[nodiscard]] static glm::vec3 cubeDirection(std::size_t texel, unsigned size);

    /// Volumes of 64 voxels a side.
    Refraction create(RefractionModel model, const Environment& environment);

    const glm::dvec3 mEye{0.3, 0.6, 4.6};
    View mView;
    Material mClear; ///< Does not bend.

private:
    Environment environmentOf(const std::vector<glm::vec4>& texels, const EnvironmentDesc& desc);
};

} // namespace lamina::test
