#include "transmittance/leaf_maps.hpp"

#include "grid/grid_constants.hpp"

namespace lamina {
namespace {

constexpr const char* kOperation = "transmittance: leaf maps";
constexpr std::uint32_t kWordBytes = 16;
constexpr std::uint32_t kRangeBytes = 8;

std::uint32_t layersOf(const glm::uvec3& size) {
    return (size.z + BitGrid::kSlicesPerGroup - 1) / BitGrid::kSlicesPerGroup;
}

} // namespace

LeafMaps::LeafMaps(const Device& device, const TransmittanceDesc& desc,
                   std::unique_ptr<Voxelizer> voxelizer)
    : mDevice(device.state())
    , mVoxelizer(std::move(voxelizer))
    , mClasses(desc.classes)
    , mMaxFaces(desc.maxFaces)
    , mIsLocal(desc.localRanges) {}

Result<LeafMaps> LeafMaps::create(const Device& device, const TransmittanceDesc& desc) {
    // A leaf is one voxel of a column however steep it is: what counts is the number of leaves.
    auto voxelizer = Voxelizer::create(device, {.backend = Backend::MrtSlicemap,
                                                .coverage = Coverage::Sampled,
                                                .localRanges = desc.localRanges,
                                                .store = VoxelStore::Texture});
    if (!voxelizer)
        return voxelizer.error();
    LeafMaps maps(device, desc, std::move(*voxelizer));
    const std::uint32_t grids = maps.isStacked() ? desc.classes : desc.maxFaces;
    for (std::uint32_t i = 0; i < grids; ++i) {
        auto grid = VoxelGrid::create(device);
        if (!grid)
            return grid.error();
        maps.mGrids.push_back(std::move(*grid));
    }
    return maps;
}

Result<LeafMaps::Face> LeafMaps::makeFace(const glm::uvec3& size) const {
    Face face;
    auto words = gl::createTextureArray(mDevice, GL_RGBA32UI, kWordBytes, size.x, size.y,
                                        mClasses * layersOf(size), kOperation, "lamina leaf maps");
    if (!words)
        return words.error();
    face.words = std::move(*words);
    if (mIsLocal) {
        auto ranges = gl::createTexture2d(mDevice, GL_RG32F, kRangeBytes, size.x, size.y,
                                          kOperation, "lamina leaf ranges");
        if (!ranges)
            return ranges.error();
        face.ranges = std::move(*ranges);
    }
    auto block = gl::createBuffer(mDevice, sizeof(GridBlock), nullptr, GL_DYNAMIC_STORAGE_BIT,
                                  kOperation, "lamina leaf grid");
    if (!block)
        return block.error();
    face.block = std::move(*block);
    return face;
}

void LeafMaps::stack(const Face& face, const glm::uvec3& size) const {
    const gl::DebugGroup group(*mDevice, "lamina: stack leaf maps");
    const GladGLContext& gl = mDevice->gl;
    const auto width = static_cast<GLsizei>(size.x);
    const auto height = static_cast<GLsizei>(size.y);
    const auto layers = static_cast<GLsizei>(layersOf(size));
    for (std::uint32_t i = 0; i < mClasses; ++i)
        gl.CopyImageSubData(mGrids[i].texture(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, face.words.id(),
                            GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(i) * layers, width,
                            height, layers);
    if (mIsLocal)
        gl.CopyImageSubData(mGrids.front().rangeTexture(), GL_TEXTURE_2D, 0, 0, 0, 0,
                            face.ranges.id(), GL_TEXTURE_2D, 0, 0, 0, 0, width, height, 1);
    const GridBlock block = makeGridBlock(*mGrids.front().transform(), mIsLocal);
    gl.NamedBufferSubData(face.block.id(), 0, sizeof block, &block);
}

Result<void> LeafMaps::build(std::span<const GeometrySource> leaves,
                             std::span<const Material> materials, const LightFaces& faces,
                             TransmittanceStats& stats) {
    VoxelizeOptions options;
    if (isStacked()) {
        options.split = Split::ColorClass;
        options.materials = materials;
    }
    for (std::size_t i = 0; i < faces.grids.size(); ++i) {
        const std::span<VoxelGrid> grids =
            isStacked() ? std::span(mGrids) : std::span(mGrids).subspan(i, 1);
        auto voxelized = mVoxelizer->voxelizeWith(leaves, faces.grids[i], options, grids);
        if (!voxelized)
            return voxelized.error();
        stats.passes += voxelized->passes;
        stats.meshTriangles = voxelized->meshTriangles;
        if (!isStacked())
            continue;
        const glm::uvec3 size = faces.grids[i].size();
        if (mFaces.size() <= i) {
            auto face = makeFace(size);
            if (!face)
                return face.error();
            mFaces.push_back(std::move(*face));
        }
        stack(mFaces[i], size);
    }
    mFaceCount = faces.grids.size();
    return {};
}

void LeafMaps::bind(GLuint uniformBufferBinding, GLuint wordUnit, GLuint rangeUnit) const {
    const GladGLContext& gl = mDevice->gl;
    for (std::uint32_t i = 0; i < mMaxFaces; ++i) {
        const std::size_t source = i < mFaceCount ? i : 0;
        if (!isStacked()) {
            mGrids[source].bind(uniformBufferBinding, wordUnit, i, rangeUnit);
            continue;
        }
        const GLuint block = mFaces[source].block.id();
        gl.BindBuffersBase(GL_UNIFORM_BUFFER, uniformBufferBinding + i, 1, &block);
        gl.BindTextureUnit(wordUnit + i, mFaces[source].words.id());
        gl.BindSampler(wordUnit + i, 0);
        if (!mIsLocal)
            continue;
        gl.BindTextureUnit(rangeUnit + i, mFaces[source].ranges.id());
        gl.BindSampler(rangeUnit + i, 0);
    }
}

std::uint64_t LeafMaps::gpuBytes() const {
    std::uint64_t bytes = 0;
    for (const VoxelGrid& grid : mGrids)
        bytes += grid.gpuBytes();
    for (const Face& face : mFaces)
        bytes += face.block.bytes() + face.words.bytes() + face.ranges.bytes();
    return bytes;
}

} // namespace lamina
