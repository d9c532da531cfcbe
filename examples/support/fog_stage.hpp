#pragma once

#include "engine_mesh.hpp"

#include <lamina/area_light/area_light.hpp>
#include <lamina/core/triangle_mesh.hpp>
#include <lamina/grid_io/image.hpp>
#include <lamina/headless/context.hpp>

#include <cstdint>
#include <vector>

namespace example {

/// What stands for an engine in the fog examples: a scene, its passes, and its textures.
class FogStage {
public:
    FogStage();
    FogStage(const FogStage&) = delete;
    FogStage& operator=(const FogStage&) = delete;

    /// A thing that casts shadows and is lit.
    void add(const lamina::TriangleMesh& mesh, const glm::vec3& albedo);
    /// A thing that glows and casts none: the light source as it is seen.
    /// corners: counterclockwise; texture: 0 for a plain one.
    void addGlow(const glm::vec3 (&corners)[4], const glm::vec3& radiance, std::uint32_t texture);
    void removeGlows();
    /// Draws depth, normals, albedo and glow for a camera.
    void draw(const glm::dmat4& worldToClip, const glm::uvec2& size);

    /// A texture with mipmaps from rows of linear RGB.
    [[nodiscard]] std::uint32_t makeTexture(const std::vector<glm::vec3>& texels,
                                            const glm::uvec2& size);

    [[nodiscard]] lamina::Device& device() { return mDevice; }
    [[nodiscard]] const lamina::View& view() const { return mView; }
    [[nodiscard]] const lamina::SurfaceTextures& surfaces() const { return mSurfaces; }
    [[nodiscard]] const std::vector<lamina::GeometrySource>& casters() const { return mCasters; }

    /// Lights what draw() drew; no casters: without any shadow.
    [[nodiscard]] lamina::Image light(const lamina::AreaLightDesc& desc,
                                      const lamina::LightSource& light,
                                      const lamina::Medium& medium, bool withShadows = true);
    void finish() const { mGl.Finish(); }

private:
    struct Part {
        EngineMesh mesh;
        glm::vec3 albedo{0.0f};
        glm::vec3 glow{0.0f};
        std::uint32_t texture = 0;
    };
    [[nodiscard]] lamina::Image toImage(std::uint32_t texture) const;

    lamina::headless::Context mContext;
    HostGl mGl;
    lamina::Device mDevice;
    std::uint32_t mProgram = 0;
    std::uint32_t mFramebuffer = 0;
    std::uint32_t mTextures[4] = {};
    std::vector<Part> mParts;
    std::vector<Part> mGlows;
    std::vector<lamina::GeometrySource> mCasters;
    lamina::View mView;
    lamina::SurfaceTextures mSurfaces;
};

/// Pictures side by side, `columns` in a row, all of one size.
[[nodiscard]] lamina::Image montage(const std::vector<lamina::Image>& images, unsigned columns);

/// |a - b| times `gain`, on black.
[[nodiscard]] lamina::Image difference(const lamina::Image& a, const lamina::Image& b, int gain);

} // namespace example
