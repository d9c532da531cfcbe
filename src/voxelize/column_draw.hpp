#pragma once

#include "gl/device_state.hpp"
#include "gl/shader_source.hpp"
#include "gl/state_guard.hpp"

#include <lamina/core/export.hpp>
#include <lamina/grid/grid_transform.hpp>
#include <lamina/voxelize/geometry_source.hpp>

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace lamina {

/// The fragment stage that owns (triangle, column) pairs; vertex and geometry stages
/// (voxelize/slicemap.geom) are given.
struct ColumnStage {
    std::string label;
    std::string fragmentShader;
    std::vector<gl::ShaderDefine> defines;
};

/// Draws sources into all depths of a grid's columns, for passes that want every crossing of a
/// column's centre line. Columns are decided in double precision by the fragment stage.
class LAMINA_API ColumnDraw {
public:
    /// One source of a call, checked.
    struct Source {
        GLuint program = 0;
        glm::dmat4 localToColumn{1.0};
        std::uint32_t materialId = 0;
    };

    explicit ColumnDraw(std::shared_ptr<gl::DeviceState> device);

    /// The program for MeshView sources. Errors: ShaderError.
    [[nodiscard]] Result<GLuint> meshProgram(const ColumnStage& stage) const;

    /// Checks sources and builds their programs.
    /// Errors: InvalidArgument, DeviceLimit, ShaderError, as Voxelizer::voxelize().
    [[nodiscard]] Result<std::vector<Source>> prepare(std::span<const GeometrySource> sources,
                                                      const GridTransform& transform,
                                                      const ColumnStage& stage) const;
    /// Uploads the constants of the prepared sources, for any number of draw().
    void upload(std::span<const Source> prepared, const GridTransform& transform);
    /// Draws all sources once. `guard` is in place and saves uniform buffer 0; framebuffer,
    /// viewport and what else the fragment stage needs are set.
    void draw(std::span<const GeometrySource> sources, std::span<const Source> prepared,
              const DrawContext& context, gl::RasterStateGuard& guard);

private:
    std::shared_ptr<gl::DeviceState> mDevice;
    gl::VertexArray mVertexArray;
    gl::Buffer mBlocks;
    std::vector<std::byte> mBytes;
    std::size_t mStride = 0;
};

} // namespace lamina
