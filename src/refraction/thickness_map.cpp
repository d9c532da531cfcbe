#include <lamina/refraction/thickness_map.hpp>

#include "core/check_enumeration.hpp"
#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/screen_pass.hpp"
#include "refraction/evaluation_table.hpp"
#include "refraction/refraction_constants.hpp"
#include "refraction/view_grid.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lamina {
namespace {

constexpr std::uint32_t kMaxSlices = 1024;
constexpr std::string_view kOperation = "thickness";

/// laminaThickness.slope of a grid: eye space changes by (x, y, 1) per depth along a pixel's ray.
glm::vec4 raySlope(const GridTransform& transform) {
    if (transform.projection() == Projection::Orthographic)
        return glm::vec4(0.0f);
    const auto pointAt = [&](double x, double y, double z) {
        return transform.gridToWorld({x, y, z});
    };
    const glm::dvec3 size(transform.size());
    // Eye space: two directions across the window, at right angles; depth 1 is 1 along the axis.
    const double near = transform.nearDepth();
    const double pixelX = glm::length(pointAt(1, 0, 0) - pointAt(0, 0, 0)) / near;
    const double pixelY = glm::length(pointAt(0, 1, 0) - pointAt(0, 0, 0)) / near;
    const glm::dvec3 corner = pointAt(0, 0, 0);
    const glm::dvec3 behind = pointAt(0, 0, size.z);
    const glm::dvec3 perDepth = (behind - corner) / (transform.farDepth() - near);
    const glm::dvec3 alongX = glm::normalize(pointAt(1, 0, 0) - corner);
    const glm::dvec3 alongY = glm::normalize(pointAt(0, 1, 0) - corner);
    return {pixelX, pixelY, glm::dot(perDepth, alongX), glm::dot(perDepth, alongY)};
}

} // namespace

struct ThicknessMap::Impl {
    std::shared_ptr<gl::DeviceState> device;
    ThicknessDesc desc;
    std::unique_ptr<Voxelizer> voxelizer;
    std::vector<VoxelGrid> grids; ///< Front faces, back faces.
    gl::ScreenPass screenPass;
    GLuint program = 0;
    gl::Texture table; ///< For IntegralMethod::Table.
    gl::Buffer constants;
    gl::Buffer report;
    gl::Texture thickness;
    glm::uvec2 size{0};
    bool isBuilt = false;

    Impl(const Device& host, const ThicknessDesc& wanted)
        : device(host.state())
        , desc(wanted)
        , screenPass(device, "lamina thickness") {}

    [[nodiscard]] Result<void> createObjects(const Device& host);
    [[nodiscard]] Result<void> createTable();
    [[nodiscard]] Result<void> reserve(const glm::uvec2& wanted);
    void integrate(const GridTransform& transform);
    [[nodiscard]] std::uint64_t gpuBytes() const {
        // The near/far map is shared.
        const std::uint64_t shared = std::uint64_t{8} * size.x * size.y;
        return table.bytes() + constants.bytes() + report.bytes() + thickness.bytes() +
               grids[0].gpuBytes() + grids[1].gpuBytes() - shared;
    }
};

Result<void> ThicknessMap::Impl::createObjects(const Device& host) {
    VoxelizerDesc wanted;
    wanted.backend = Backend::MrtSlicemap;
    wanted.localRanges = true;
    wanted.store = VoxelStore::Texture;
    auto created = Voxelizer::create(host, wanted);
    if (!created)
        return created.error();
    voxelizer = std::move(*created);
    for (int i = 0; i < 2; ++i) {
        auto grid = VoxelGrid::create(host);
        if (!grid)
            return grid.error();
        grids.push_back(std::move(*grid));
    }
    auto built = gl::findOrBuildProgram(
        *device,
        {"lamina thickness",
         {{GL_VERTEX_SHADER, "gl/screen.vert"}, {GL_FRAGMENT_SHADER, "refraction/thickness.frag"}},
         {{"LAMINA_INTEGRAL_METHOD", std::to_string(static_cast<int>(desc.method))}}});
    if (!built)
        return built.error();
    program = *built;
    auto block = gl::createBuffer(device, sizeof(shared::LaminaThicknessConstants), nullptr,
                                  GL_DYNAMIC_STORAGE_BIT, kOperation, "lamina thickness constants");
    if (!block)
        return block.error();
    constants = std::move(*block);
    auto counts = gl::createBuffer(device, sizeof(shared::LaminaThicknessCounts), nullptr, 0,
                                   kOperation, "lamina thickness report");
    if (!counts)
        return counts.error();
    report = std::move(*counts);
    return desc.method == IntegralMethod::Table ? createTable() : Result<void>{};
}

Result<void> ThicknessMap::Impl::createTable() {
    constexpr GLsizei kSize = LAMINA_INTEGRAL_TABLE_SIZE;
    auto texture = gl::createTexture2d(device, GL_RGBA8, 4, kSize, kSize, kOperation,
                                       "lamina evaluation table");
    if (!texture)
        return texture.error();
    table = std::move(*texture);
    const std::vector<glm::u8vec4> texels = makeEvaluationTable();
    const gl::PixelUnpackGuard guard(*device);
    device->gl.TextureSubImage2D(table.id(), 0, 0, 0, kSize, kSize, GL_RGBA, GL_UNSIGNED_BYTE,
                                 texels.data());
    return {};
}

Result<void> ThicknessMap::Impl::reserve(const glm::uvec2& wanted) {
    if (wanted == size)
        return {};
    auto texture =
        gl::createTexture2d(device, GL_R32F, 4, wanted.x, wanted.y, kOperation, "lamina thickness");
    if (!texture)
        return texture.error();
    thickness = std::move(*texture);
    size = wanted;
    return {};
}

void ThicknessMap::Impl::integrate(const GridTransform& transform) {
    const GladGLContext& gl = device->gl;
    const gl::TextureUnitGuard textures(*device, 0, LAMINA_THICKNESS_UNITS);
    const gl::IndexedBufferBindings uniforms(gl, GL_UNIFORM_BUFFER, LAMINA_THICKNESS_BLOCKS);
    const gl::DrawBufferGuard buffers(*device, 1);
    const shared::LaminaThicknessConstants block{raySlope(transform)};
    gl.NamedBufferSubData(constants.id(), 0, sizeof block, &block);
    gl.ClearNamedBufferData(report.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    for (std::uint32_t i = 0; i < 2; ++i)
        grids[i].bind(LAMINA_THICKNESS_GRID_BINDING, LAMINA_THICKNESS_GRID_UNIT, i,
                      LAMINA_THICKNESS_RANGE_UNIT);
    gl.BindTextureUnit(LAMINA_THICKNESS_TABLE_UNIT, table.id());
    gl.BindSampler(LAMINA_THICKNESS_TABLE_UNIT, 0);
    const GLuint constantBlock = constants.id();
    gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_THICKNESS_BLOCK_BINDING, 1, &constantBlock);
    const GLuint counts = report.id();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_THICKNESS_REPORT_BINDING, 1, &counts);
    const GLuint target = thickness.id();
    screenPass.draw(program, {&target, 1}, size);
    uniforms.restore(gl);
}

ThicknessMap::ThicknessMap(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
ThicknessMap::ThicknessMap(ThicknessMap&&) noexcept = default;
ThicknessMap& ThicknessMap::operator=(ThicknessMap&&) noexcept = default;
ThicknessMap::~ThicknessMap() = default;

Result<ThicknessMap> ThicknessMap::create(const Device& device, const ThicknessDesc& desc) {
    if (auto known =
            checkEnumeration(kOperation, "IntegralMethod", desc.method, IntegralMethod::Table);
        !known)
        return known.error();
    if (desc.slices < 1 || desc.slices > kMaxSlices)
        return Error{ErrorCode::InvalidArgument,
                     "thickness: expected 1 to 1024 slices, found " + std::to_string(desc.slices)};
    const gl::DebugGroup group(*device.state(), "lamina: create thickness map");
    auto impl = std::make_unique<Impl>(device, desc);
    if (auto created = impl->createObjects(device); !created)
        return created.error();
    return ThicknessMap(std::move(impl));
}

Result<ThicknessStats> ThicknessMap::build(std::span<const GeometrySource> sources,
                                           const View& view, const Box3& bounds) {
    Impl& impl = *mImpl;
    const gl::DebugGroup group(*impl.device, "lamina: build thickness map");
    const auto transform = makeViewGrid(view, bounds, impl.desc.slices, kOperation);
    if (!transform)
        return transform.error();
    impl.isBuilt = false;
    VoxelizeOptions options;
    options.split = Split::Facing;
    const auto voxelized = impl.voxelizer->voxelizeWith(sources, *transform, options, impl.grids);
    if (!voxelized)
        return voxelized.error();
    if (auto reserved = impl.reserve(view.size); !reserved)
        return reserved.error();
    impl.integrate(*transform);
    impl.isBuilt = true;
    return ThicknessStats{voxelized->sources, voxelized->passes, voxelized->meshTriangles,
                          impl.gpuBytes()};
}

std::uint32_t ThicknessMap::texture() const {
    return mImpl->thickness.id();
}

glm::uvec2 ThicknessMap::size() const {
    return mImpl->size;
}

const VoxelGrid& ThicknessMap::frontFaces() const {
    return mImpl->grids[0];
}

const VoxelGrid& ThicknessMap::backFaces() const {
    return mImpl->grids[1];
}

Result<ThicknessReport> ThicknessMap::downloadReport() const {
    if (!mImpl->isBuilt)
        return Error{ErrorCode::InvalidArgument,
                     "thickness: expected a map to report on, found none; call build() first"};
    const GladGLContext& gl = mImpl->device->gl;
    shared::LaminaThicknessCounts counts{};
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.GetNamedBufferSubData(mImpl->report.id(), 0, sizeof counts, &counts);
    return ThicknessReport{counts.openColumns, counts.ambiguousColumns};
}

const ThicknessDesc& ThicknessMap::desc() const {
    return mImpl->desc;
}

std::uint64_t ThicknessMap::gpuBytes() const {
    return mImpl->gpuBytes();
}

} // namespace lamina
