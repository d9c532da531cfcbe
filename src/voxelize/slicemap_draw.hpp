#pragma once

#include "gl/device_state.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"

#include <lamina/grid/grid_transform.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace lamina {

/// A fragment stage of the slicemap passes, and how it is compiled.
struct SlicemapStage {
    std::string fragment; ///< In the shader library.
    std::vector<gl::ShaderDefine> defines;
};

/// Near and far depth of every column: for MIN blending into GL_RG32F, cleared to
/// LAMINA_EMPTY_COLUMN.
[[nodiscard]] LAMINA_API SlicemapStage slicemapRangeStage(Coverage coverage);

/// The value of the shaders' LAMINA_COVERAGE.
[[nodiscard]] std::string slicemapCoverage(Coverage coverage);

/// Sources with their programs, ready to be drawn.
struct SlicemapSources {
    struct Entry {
        GLuint program = 0;
        glm::dmat4 localToColumn{1.0};
        std::uint32_t materialId = 0;
    };

    std::span<const GeometrySource> sources;
    std::vector<Entry> entries;
    std::uint64_t meshTriangles = 0; ///< Of the MeshView sources.
};

/// One pass over sources.
struct SlicemapPass {
    const SlicemapSources* sources = nullptr;
    std::uint32_t firstSlice = 0;
    std::uint32_t sliceCount = 0;
    double nearDepth = 0.0; ///< Triangles outside these depths have nothing to set.
    double farDepth = 0.0;
    std::uint32_t skippedWords = 0; ///< LaminaDrawConstants.passDepths.w
    std::uint32_t gridCount = 1;    ///< LaminaDrawConstants.pass.z
    std::uint32_t split = 0;        ///< LAMINA_SPLIT_*
};

/// Draws the geometry of slicemap passes: one vertex and geometry stage for all of them.
class LAMINA_API SlicemapDraw {
public:
    explicit SlicemapDraw(std::shared_ptr<gl::DeviceState> device);

    /// The program of `stage` for MeshView sources.
    [[nodiscard]] Result<GLuint> meshProgram(const SlicemapStage& stage) const;

    /// Checks sources and builds their programs.
    /// Errors: those of Voxelizer::voxelize().
    [[nodiscard]] Result<SlicemapSources> prepare(std::span<const GeometrySource> sources,
                                                  const GridTransform& transform,
                                                  const SlicemapStage& stage) const;

    /// Makes the constants of all draws of these passes; between them and the draws nothing else
    /// may be uploaded.
    void upload(std::span<const SlicemapPass> passes, const GridTransform& transform);

    /// Draws uploaded pass `index` with its programs, constants, and what `bind` binds before each
    /// source: a host's callback may bind something else.
    template<class Bind>
    void draw(std::span<const SlicemapPass> passes, std::uint32_t index,
              gl::RasterStateGuard& guard, Bind&& bind) {
        const SlicemapSources& sources = *passes[index].sources;
        for (std::size_t i = 0; i < sources.sources.size(); ++i) {
            bind();
            drawSource(passes, index, i, guard);
        }
    }

private:
    void drawSource(std::span<const SlicemapPass> passes, std::uint32_t index, std::size_t source,
                    gl::RasterStateGuard& guard);

    std::shared_ptr<gl::DeviceState> mDevice;
    gl::VertexArray mVertexArray;
    gl::Buffer mBlocks;
    std::vector<std::byte> mBytes;
    std::vector<std::size_t> mOffsets; ///< Of each pass's first block.
    std::size_t mStride = 0;
};

} // namespace lamina
