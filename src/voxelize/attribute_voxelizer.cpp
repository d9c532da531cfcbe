#include <lamina/voxelize/attribute_voxelizer.hpp>

#include "gl/binding_guards.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/attribute_constants.hpp"
#include "voxelize/overlap_passes.hpp"
#include "voxelize/volume_draw.hpp"
#include "voxelize/voxel_attributes_impl.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lamina {
namespace {

constexpr std::uint64_t kRecordBytes = LAMINA_RECORD_WORDS * sizeof(std::uint32_t);
/// Of the low or the high words.
constexpr std::uint64_t kSumBytes = LAMINA_SUM_WORDS * sizeof(std::uint32_t);
/// So that a batch's records begin at an aligned offset.
constexpr std::uint64_t kBatchStep = 4096;
constexpr std::uint64_t kMostBatchVoxels = std::uint64_t{1} << 23u;

/// Voxels whose sums a storage binding holds.
std::uint64_t batchLimit(const gl::DeviceState& device) {
    return std::min(device.limits.maxStorageBlockBytes / kSumBytes, kMostBatchVoxels) / kBatchStep *
           kBatchStep;
}

Result<void> checkGrid(const VoxelGrid& voxels) {
    const GridTransform* transform = voxels.transform();
    if (!transform)
        return Error{ErrorCode::InvalidArgument,
                     "voxel attributes: expected voxels, found a grid of no size; voxelize into it "
                     "first"};
    if (voxels.hasLocalRanges())
        return Error{ErrorCode::Unsupported,
                     "voxel attributes: expected one range of depths for all columns, found a " +
                         transform->describe() +
                         " grid with local ranges; resample it by BitGrid::toUniform() and upload "
                         "the result"};
    if (transform->projection() != Projection::Orthographic ||
        transform->distribution().kind() != SliceDistribution::Kind::Linear)
        return Error{ErrorCode::Unsupported,
                     "voxel attributes: expected an orthographic grid with linear slices, found " +
                         transform->describe() +
                         (transform->projection() == Projection::Orthographic
                              ? " with logarithmic or custom slices"
                              : "") +
                         "; use VolumeVoxelizer"};
    return {};
}

Result<void> checkMaterialIds(std::span<const GeometrySource> sources, std::size_t materialCount) {
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (const auto* view = std::get_if<MeshView>(&sources[i]);
            view && view->materialId >= materialCount)
            return Error{ErrorCode::InvalidArgument,
                         "voxelize: source " + std::to_string(i) +
                             ": expected a material id below " + std::to_string(materialCount) +
                             ", found " + std::to_string(view->materialId)};
    return {};
}

/// The colour of all surfaces, if they have one: no vertex colours, and materials of one colour.
std::optional<glm::vec4> commonColor(std::span<const OverlapSource> sources,
                                     std::span<const Material> materials) {
    std::optional<glm::vec4> common;
    for (const OverlapSource& source : sources) {
        if (source.view.colors.buffer != 0 || source.hasVertexMaterials)
            return std::nullopt;
        const glm::vec4 color = materials[source.view.materialId].color;
        if (common && *common != color)
            return std::nullopt;
        common = color;
    }
    return common;
}

/// All columns, LAMINA_ATTRIBUTE_PART_SLICES slices each.
std::vector<GridPart> attributeParts(const glm::uvec3& size) {
    std::vector<GridPart> parts;
    for (std::uint32_t z = 0; z < size.z; z += LAMINA_ATTRIBUTE_PART_SLICES) {
        GridPart part;
        part.low = {0, 0, z};
        part.high = {size.x - 1, size.y - 1,
                     std::min<std::uint32_t>(z + LAMINA_ATTRIBUTE_PART_SLICES, size.z) - 1};
        parts.push_back(part);
    }
    return parts;
}

/// From cross products in grid coordinates to those in the world, relative to the largest section
/// of a voxel: no section's area exceeds the length of the vector of the areas of three faces.
glm::dmat3 areaToWorld(const GridTransform& transform) {
    const glm::dmat3 gridToWorld = glm::inverse(glm::dmat3(overlapWorldToGrid(transform)));
    const glm::dmat3 areas = cofactors(gridToWorld);
    return areas / glm::length(glm::dvec3(glm::length(areas[0]), glm::length(areas[1]),
                                          glm::length(areas[2])));
}

} // namespace

struct AttributeVoxelizer::Impl {
    explicit Impl(std::shared_ptr<gl::DeviceState> state)
        : device(std::move(state))
        , sources(device, CaptureContent::Surfaces)
        , passes(device)
        , ranker(device)
        , batchBlock(gl::Buffer::create(device, "lamina attribute constants"))
        , materialBlock(gl::Buffer::create(device, "lamina materials")) {}

    [[nodiscard]] Result<void> initialize();
    [[nodiscard]] Result<GLuint> program(const char* shader, std::size_t store,
                                         bool hasColors) const;
    /// Makes room for the sums of so many voxels.
    [[nodiscard]] Result<void> reserveSums(std::uint64_t voxels);
    void uploadMaterials(std::span<const Material> materials);
    void uploadBatch(const GridTransform& transform, std::uint64_t firstVoxel, std::uint64_t count,
                     std::size_t materialCount, const std::optional<glm::vec4>& color);
    /// Binds a batch's records and sums, and clears them.
    void beginBatch(const gl::Buffer& records, std::uint64_t firstVoxel, std::uint64_t count);
    void resolve(std::uint64_t voxels) const;

    std::shared_ptr<gl::DeviceState> device;
    OverlapSources sources;
    OverlapPasses passes;
    VoxelRanker ranker;
    std::array<std::array<OverlapPrograms, 2>, 2> programs{}; ///< By VoxelStore; with colours.
    GLuint resolveProgram = 0;
    gl::Buffer batchBlock;
    gl::Buffer materialBlock;
    gl::Buffer sumsLow;
    gl::Buffer sumsHigh;
};

Result<GLuint> AttributeVoxelizer::Impl::program(const char* shader, std::size_t store,
                                                 bool hasColors) const {
    return gl::findOrBuildProgram(*device, {"lamina attributes",
                                            {{GL_COMPUTE_SHADER, shader}},
                                            {{"LAMINA_GRID_BUFFER_STORE", std::to_string(store)},
                                             {"LAMINA_ATTRIBUTE_COLORS", hasColors ? "1" : "0"}}});
}

Result<void> AttributeVoxelizer::Impl::initialize() {
    for (std::size_t store = 0; store < programs.size(); ++store)
        for (const bool hasColors : {false, true}) {
            auto smallTriangles = program("voxelize/attributes.comp", store, hasColors);
            if (!smallTriangles)
                return smallTriangles.error();
            auto largeTriangles = program("voxelize/attributes_large.comp", store, hasColors);
            if (!largeTriangles)
                return largeTriangles.error();
            programs[store][hasColors ? 1 : 0] = {*smallTriangles, *largeTriangles};
        }
    auto resolver = gl::findOrBuildProgram(
        *device,
        {"lamina attribute resolve", {{GL_COMPUTE_SHADER, "voxelize/attribute_resolve.comp"}}, {}});
    if (!resolver)
        return resolver.error();
    resolveProgram = *resolver;
    if (auto ready = ranker.initialize(); !ready)
        return ready;
    return passes.initialize();
}

Result<void> AttributeVoxelizer::Impl::reserveSums(std::uint64_t voxels) {
    const std::uint64_t bytes = std::max<std::uint64_t>(voxels, 1) * kSumBytes;
    for (gl::Buffer* sums : {&sumsLow, &sumsHigh}) {
        if (sums->bytes() >= bytes)
            continue;
        auto buffer = gl::createBuffer(device, bytes, nullptr, 0,
                                       "attribute sums of " + std::to_string(voxels) + " voxels",
                                       "lamina attribute sums");
        if (!buffer)
            return buffer.error();
        *sums = std::move(*buffer);
    }
    return {};
}

void AttributeVoxelizer::Impl::uploadMaterials(std::span<const Material> materials) {
    std::vector<shared::LaminaMaterialConstants> table(LAMINA_MAX_MATERIALS);
    std::ranges::transform(materials, table.begin(), materialConstants);
    device->gl.NamedBufferData(materialBlock.id(),
                               static_cast<GLsizeiptr>(std::span(table).size_bytes()), table.data(),
                               GL_STREAM_DRAW);
}

void AttributeVoxelizer::Impl::uploadBatch(const GridTransform& transform, std::uint64_t firstVoxel,
                                           std::uint64_t count, std::size_t materialCount,
                                           const std::optional<glm::vec4>& color) {
    shared::LaminaAttributeConstants constants{};
    const glm::dmat3 rows = glm::transpose(areaToWorld(transform));
    for (int row = 0; row < 3; ++row)
        constants.areaToWorld[row] = glm::vec4(glm::vec3(rows[row]), 0.0f);
    constants.batch = {firstVoxel, count, materialCount - 1, color ? 1 : 0};
    constants.color = color.value_or(glm::vec4(0.0f));
    device->gl.NamedBufferData(batchBlock.id(), sizeof constants, &constants, GL_STREAM_DRAW);
}

void AttributeVoxelizer::Impl::beginBatch(const gl::Buffer& records, std::uint64_t firstVoxel,
                                          std::uint64_t count) {
    const GladGLContext& gl = device->gl;
    const auto bind = [&](GLuint binding, const gl::Buffer& buffer, std::uint64_t firstByte,
                          std::uint64_t bytes) {
        const GLuint id = buffer.id();
        const auto offset = static_cast<GLintptr>(firstByte);
        const auto size = static_cast<GLsizeiptr>(bytes);
        gl.ClearNamedBufferSubData(id, GL_R32UI, offset, size, GL_RED_INTEGER, GL_UNSIGNED_INT,
                                   nullptr);
        gl.BindBuffersRange(GL_SHADER_STORAGE_BUFFER, binding, 1, &id, &offset, &size);
    };
    bind(LAMINA_ATTRIBUTE_RECORDS_BINDING, records, firstVoxel * kRecordBytes,
         count * kRecordBytes);
    bind(LAMINA_ATTRIBUTE_SUMS_LOW_BINDING, sumsLow, 0, count * kSumBytes);
    bind(LAMINA_ATTRIBUTE_SUMS_HIGH_BINDING, sumsHigh, 0, count * kSumBytes);
}

void AttributeVoxelizer::Impl::resolve(std::uint64_t voxels) const {
    constexpr std::uint64_t kMaxGroups = LAMINA_OVERLAP_MAX_GROUPS;
    const std::uint64_t groups = (voxels + 63) / 64;
    device->gl.UseProgram(resolveProgram);
    device->gl.DispatchCompute(static_cast<GLuint>(std::min(groups, kMaxGroups)),
                               static_cast<GLuint>((groups + kMaxGroups - 1) / kMaxGroups), 1);
}

AttributeVoxelizer::AttributeVoxelizer(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
AttributeVoxelizer::AttributeVoxelizer(AttributeVoxelizer&&) noexcept = default;
AttributeVoxelizer& AttributeVoxelizer::operator=(AttributeVoxelizer&&) noexcept = default;
AttributeVoxelizer::~AttributeVoxelizer() = default;

Result<AttributeVoxelizer> AttributeVoxelizer::create(const Device& device) {
    auto impl = std::make_unique<Impl>(device.state());
    if (auto ready = impl->initialize(); !ready)
        return ready.error();
    return AttributeVoxelizer(std::move(impl));
}

Result<AttributeStats> AttributeVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                    std::span<const Material> materials,
                                                    const VoxelGrid& voxels, VoxelAttributes& out) {
    Impl& impl = *mImpl;
    VoxelAttributes::Impl& result = *out.mImpl;
    const Material defaultMaterial;
    if (materials.empty())
        materials = {&defaultMaterial, 1};
    constexpr const char* kOperation = "attribute voxelizer";
    if (auto own = gl::checkSameDevice(*impl.device, voxels.deviceState(), kOperation, "a grid");
        !own)
        return own.error();
    if (auto own = gl::checkSameDevice(*impl.device, result.device.get(), kOperation, "attributes");
        !own)
        return own.error();
    if (auto valid = checkGrid(voxels); !valid)
        return valid.error();
    if (auto valid = checkMaterials(materials); !valid)
        return valid.error();
    if (auto valid = checkMaterialIds(sources, materials.size()); !valid)
        return valid.error();
    const GridTransform& transform = *voxels.transform();
    const gl::DebugGroup group(*impl.device, "lamina: voxelize attributes");
    VoxelizeStats counted;
    auto prepared = impl.sources.prepare(sources, transform, counted);
    if (!prepared)
        return prepared.error();

    result.transform.reset();
    const GladGLContext& gl = impl.device->gl;
    if (auto reserved = impl.ranker.reserve(transform, result.ranks); !reserved)
        return reserved.error();
    const gl::ComputeStateGuard guard(*impl.device, LAMINA_ATTRIBUTE_UNIFORM_COUNT,
                                      LAMINA_ATTRIBUTE_BINDING_COUNT);
    const gl::TextureUnitGuard textureGuard(*impl.device, 0, LAMINA_ATTRIBUTE_PASS_UNITS);
    const gl::PixelUnpackGuard unpackGuard(*impl.device); // clears of buffers depend on it
    // The host's shaders may have written the vertices.
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                     GL_TEXTURE_FETCH_BARRIER_BIT);
    voxels.bind(LAMINA_PASS_GRID_BLOCK_BINDING, 0);
    impl.ranker.rank(voxels, result.ranks);
    const std::uint64_t count = result.desc.maxVoxels != 0
                                    ? result.desc.maxVoxels
                                    : readVoxelCount(*impl.device, result.ranks);
    const std::uint64_t batch = std::min(count, batchLimit(*impl.device));
    if (auto reserved = result.reserve(count); !reserved)
        return reserved.error();
    if (auto reserved = impl.reserveSums(batch); !reserved)
        return reserved.error();

    const std::vector<GridPart> parts = attributeParts(transform.size());
    impl.passes.begin(*prepared, parts, transform);
    impl.uploadMaterials(materials);
    const GLuint materialBlock = impl.materialBlock.id();
    const GLuint batchBlock = impl.batchBlock.id();
    gl.BindTextureUnit(1, result.ranks.texture.id());
    gl.BindSampler(1, 0);
    const std::optional<glm::vec4> color = commonColor(*prepared, materials);
    const OverlapPrograms& programs =
        impl.programs[static_cast<std::size_t>(voxels.store())][color ? 0 : 1];
    AttributeStats stats;
    for (std::uint64_t first = 0; first < count; first += batch) {
        const std::uint64_t size = std::min(batch, count - first);
        impl.beginBatch(result.records, first, size);
        impl.uploadBatch(transform, first, size, materials.size(), color);
        gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_VOLUME_MATERIAL_BLOCK_BINDING, 1,
                           &materialBlock);
        gl.BindBuffersBase(GL_UNIFORM_BUFFER, LAMINA_ATTRIBUTE_BLOCK_BINDING, 1, &batchBlock);
        for (std::size_t part = 0; part < parts.size(); ++part)
            impl.passes.run(programs, part);
        impl.resolve(size);
        gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                         GL_TEXTURE_FETCH_BARRIER_BIT);
        stats.passes += static_cast<std::uint32_t>(parts.size());
    }
    result.transform = transform;
    stats.sources = static_cast<std::uint32_t>(sources.size());
    stats.meshTriangles = counted.meshTriangles;
    stats.voxels = count;
    stats.attributeBytes = out.gpuBytes();
    stats.scratchBytes = impl.sumsLow.bytes() + impl.sumsHigh.bytes();
    return stats;
}

} // namespace lamina
