#include "gl/binding_guards.hpp"
#include "gl/fetch_sampler.hpp"
#include "gl/program_cache.hpp"
#include "gl/state_guard.hpp"
#include "voxelize/epipolar_depth_maps.hpp"
#include "voxelize/epipolar_host_maps.hpp"

#include <lamina/voxelize/epipolar_voxelizer.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace lamina {
namespace {

/// Depth maps held at a time; more lights are served in batches.
constexpr std::uint64_t kMaxDepthBytes = std::uint64_t{256} << 20;

/// Where a batch's depths come from.
struct DepthSource {
    GLuint texture = 0;
    int map = LAMINA_EPIPOLAR_MAP_OWN;
    auto operator<=>(const DepthSource&) const = default;
};

struct Programs {
    GLuint rectify = 0;
    GLuint scan = 0;
};

int mapOf(DepthMapKind kind) {
    switch (kind) {
    case DepthMapKind::Texture2D:
        return LAMINA_EPIPOLAR_MAP_2D;
    case DepthMapKind::TextureArray:
        return LAMINA_EPIPOLAR_MAP_ARRAY;
    case DepthMapKind::TextureCube:
        return LAMINA_EPIPOLAR_MAP_CUBE;
    case DepthMapKind::HemisphereArray:
        break;
    }
    return LAMINA_EPIPOLAR_MAP_HEMISPHERE;
}

Result<void> checkAlpha(std::span<const EpipolarTransform> transforms) {
    if (!transforms.empty() && transforms.front().size().x > LAMINA_EPIPOLAR_MAX_ALPHA)
        return Error{ErrorCode::DeviceLimit,
                     "epipolar voxelize: expected at most " +
                         std::to_string(LAMINA_EPIPOLAR_MAX_ALPHA) + " voxels along alpha, found " +
                         std::to_string(transforms.front().size().x) + "; use fewer"};
    return {};
}

Result<void> checkOwn(const gl::DeviceState& device, const EpipolarGrid& grid) {
    return gl::checkSameDevice(device, grid.deviceState(), "epipolar voxelizer", "a grid");
}

} // namespace

struct EpipolarVoxelizer::Impl {
    Impl(const std::shared_ptr<gl::DeviceState>& state, const EpipolarVoxelizerDesc& wanted)
        : device(state)
        , desc(wanted)
        , depthMaps(state, wanted.depthMapTexels)
        , sampler(state)
        , maps(gl::Buffer::create(state, "lamina light depth maps")) {}

    [[nodiscard]] Result<GLuint> rectifyProgram(int map, std::uint32_t alphaCount) const;
    [[nodiscard]] Result<GLuint> scanProgram() const {
        return gl::findOrBuildProgram(
            *device,
            {"lamina epipolar scan", {{GL_COMPUTE_SHADER, "voxelize/epipolar_scan.comp"}}, {}});
    }
    void rectifyBatch(GLuint program, GLuint texture,
                      std::span<const shared::LaminaEpipolarMap> blocks, const EpipolarGrid& out);
    Result<EpipolarStats> fromGeometry(std::span<const GeometrySource> sources,
                                       std::span<const EpipolarTransform> transforms,
                                       EpipolarGrid& out);
    Result<EpipolarStats> fromMaps(std::span<const LightDepthMap> hostMaps,
                                   std::span<const EpipolarTransform> transforms,
                                   EpipolarGrid& out);

    std::shared_ptr<gl::DeviceState> device;
    EpipolarVoxelizerDesc desc;
    DepthMapRenderer depthMaps;
    gl::FetchSampler sampler;
    gl::Buffer maps;
};

Result<GLuint> EpipolarVoxelizer::Impl::rectifyProgram(int map, std::uint32_t alphaCount) const {
    const char* capacity = alphaCount <= 128 ? "128" : (alphaCount <= 512 ? "512" : "2048");
    return gl::findOrBuildProgram(*device, {"lamina epipolar rectify",
                                            {{GL_COMPUTE_SHADER, "voxelize/epipolar_rectify.comp"}},
                                            {{"LAMINA_EPIPOLAR_MAP", std::to_string(map)},
                                             {"LAMINA_EPIPOLAR_ALPHA_CAPACITY", capacity}}});
}

void EpipolarVoxelizer::Impl::rectifyBatch(GLuint program, GLuint texture,
                                           std::span<const shared::LaminaEpipolarMap> blocks,
                                           const EpipolarGrid& out) {
    const gl::DebugGroup group(*device, "lamina: rectify light depths");
    const GladGLContext& gl = device->gl;
    const gl::ComputeStateGuard guard(*device, 0, 2);
    const gl::TextureUnitGuard textures(*device, LAMINA_EPIPOLAR_PASS_DEPTH_UNIT, 1);
    const gl::ImageUnitGuard images(*device, LAMINA_EPIPOLAR_PASS_WORD_IMAGE + 1);
    // New storage each time: dispatches of the last call may still read the old.
    gl.NamedBufferData(maps.id(), static_cast<GLsizeiptr>(blocks.size_bytes()), blocks.data(),
                       GL_STREAM_DRAW);
    const GLuint buffers[] = {out.buffer(), maps.id()};
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_EPIPOLAR_PASS_SPACE_BINDING, 2, buffers);
    gl.BindTextureUnit(LAMINA_EPIPOLAR_PASS_DEPTH_UNIT, texture);
    gl.BindSampler(LAMINA_EPIPOLAR_PASS_DEPTH_UNIT, sampler.id());
    gl.BindImageTexture(LAMINA_EPIPOLAR_PASS_WORD_IMAGE, out.texture(), 0, GL_TRUE, 0,
                        GL_WRITE_ONLY, GL_RGBA32UI);
    gl.UseProgram(program);
    const std::uint32_t rows = out.transforms().front().size().y;
    gl.DispatchCompute((rows + LAMINA_EPIPOLAR_RECTIFY_ROWS - 1) / LAMINA_EPIPOLAR_RECTIFY_ROWS,
                       out.groupCount(), static_cast<GLuint>(blocks.size()));
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                     GL_TEXTURE_UPDATE_BARRIER_BIT);
}

Result<EpipolarStats>
EpipolarVoxelizer::Impl::fromGeometry(std::span<const GeometrySource> sources,
                                      std::span<const EpipolarTransform> transforms,
                                      EpipolarGrid& out) {
    const gl::DebugGroup group(*device, "lamina: voxelize (epipolar)");
    if (auto own = checkOwn(*device, out); !own)
        return own.error();
    if (auto sound = checkEpipolarLayout(transforms, out.layout()); !sound)
        return sound.error();
    if (auto sound = checkAlpha(transforms); !sound)
        return sound.error();
    auto programs = depthMaps.prepare(sources);
    if (!programs)
        return programs.error();
    const auto rectify = rectifyProgram(LAMINA_EPIPOLAR_MAP_OWN, transforms.front().size().x);
    if (!rectify)
        return rectify.error();

    std::vector<DepthMapPlan> plans;
    std::uint64_t faceCount = 0;
    for (std::uint32_t vsv = 0; vsv < transforms.size(); ++vsv) {
        plans.push_back(planDepthMaps(transforms[vsv], desc, vsv));
        faceCount += plans.back().faces.size();
    }
    constexpr std::uint64_t kMaxFaces = 6;
    const std::uint64_t mostLayers = std::clamp<std::uint64_t>(
        kMaxDepthBytes / depthMaps.layerBytes(), kMaxFaces, device->limits.maxArrayTextureLayers);
    if (auto room = depthMaps.reserve(static_cast<std::uint32_t>(std::min(faceCount, mostLayers)));
        !room)
        return room.error();
    if (auto resized = out.resize(transforms); !resized)
        return resized.error();

    EpipolarStats stats;
    stats.shadowVolumes = static_cast<std::uint32_t>(transforms.size());
    stats.depthMaps = static_cast<std::uint32_t>(faceCount);
    for (std::size_t first = 0; first < plans.size();) {
        std::vector<DepthMapFace> faces;
        std::vector<shared::LaminaEpipolarMap> blocks;
        for (; first < plans.size() && faces.size() + plans[first].faces.size() <= mostLayers;
             ++first) {
            shared::LaminaEpipolarMap block = plans[first].map;
            const auto base = static_cast<int>(faces.size());
            for (int i = 0; i < 4; ++i)
                block.layers[i] += block.layers[i] < 0 ? 0 : base;
            for (int i = 0; i < 2; ++i)
                block.layersAndSpace[i] += block.layersAndSpace[i] < 0 ? 0 : base;
            blocks.push_back(block);
            faces.insert(faces.end(), plans[first].faces.begin(), plans[first].faces.end());
        }
        depthMaps.draw(sources, *programs, faces);
        rectifyBatch(*rectify, depthMaps.texture().id(), blocks, out);
        ++stats.batches;
    }
    stats.gridBytes = out.gpuBytes();
    stats.depthBytes = depthMaps.texture().bytes();
    return stats;
}

Result<EpipolarStats>
EpipolarVoxelizer::Impl::fromMaps(std::span<const LightDepthMap> hostMaps,
                                  std::span<const EpipolarTransform> transforms,
                                  EpipolarGrid& out) {
    const gl::DebugGroup group(*device, "lamina: voxelize (epipolar)");
    if (hostMaps.size() != transforms.size())
        return Error{ErrorCode::InvalidArgument,
                     "epipolar voxelize: expected a depth map for each of the " +
                         std::to_string(transforms.size()) + " transforms, found " +
                         std::to_string(hostMaps.size())};
    if (auto own = checkOwn(*device, out); !own)
        return own.error();
    if (auto sound = checkEpipolarLayout(transforms, out.layout()); !sound)
        return sound.error();
    if (auto sound = checkAlpha(transforms); !sound)
        return sound.error();
    std::map<DepthSource, std::vector<shared::LaminaEpipolarMap>> batches;
    for (std::size_t i = 0; i < hostMaps.size(); ++i) {
        auto block = makeHostMap(*device, hostMaps[i], transforms[i], i);
        if (!block)
            return block.error();
        batches[{hostMaps[i].texture, mapOf(hostMaps[i].kind)}].push_back(*block);
    }
    std::vector<GLuint> programs;
    for (const auto& [source, blocks] : batches) {
        auto program = rectifyProgram(source.map, transforms.front().size().x);
        if (!program)
            return program.error();
        programs.push_back(*program);
    }
    if (auto resized = out.resize(transforms); !resized)
        return resized.error();
    std::size_t next = 0;
    for (const auto& [source, blocks] : batches)
        rectifyBatch(programs[next++], source.texture, blocks, out);

    EpipolarStats stats;
    stats.shadowVolumes = static_cast<std::uint32_t>(transforms.size());
    stats.batches = static_cast<std::uint32_t>(batches.size());
    stats.gridBytes = out.gpuBytes();
    stats.depthBytes = depthMaps.texture().bytes();
    return stats;
}

EpipolarVoxelizer::EpipolarVoxelizer(std::unique_ptr<Impl> impl)
    : mImpl(std::move(impl)) {}
EpipolarVoxelizer::EpipolarVoxelizer(EpipolarVoxelizer&&) noexcept = default;
EpipolarVoxelizer& EpipolarVoxelizer::operator=(EpipolarVoxelizer&&) noexcept = default;
EpipolarVoxelizer::~EpipolarVoxelizer() = default;

Result<EpipolarVoxelizer> EpipolarVoxelizer::create(const Device& device,
                                                    const EpipolarVoxelizerDesc& desc) {
    const DeviceLimits& limits = device.limits();
    const std::uint32_t most =
        std::min({limits.maxTextureSize, limits.maxViewportWidth, limits.maxViewportHeight});
    if (desc.depthMapTexels == 0 || desc.depthMapTexels > most)
        return Error{desc.depthMapTexels == 0 ? ErrorCode::InvalidArgument : ErrorCode::DeviceLimit,
                     "epipolar voxelizer: expected depth maps of 1 to " + std::to_string(most) +
                         " texels a side, found " + std::to_string(desc.depthMapTexels)};
    if (!(desc.nearShare > 0.0 && desc.nearShare < 1.0))
        return Error{ErrorCode::InvalidArgument,
                     "epipolar voxelizer: expected a near share in (0, 1), found " +
                         std::to_string(desc.nearShare)};
    auto impl = std::make_unique<Impl>(device.state(), desc);
    if (auto scan = impl->scanProgram(); !scan)
        return scan.error();
    return EpipolarVoxelizer(std::move(impl));
}

Result<EpipolarStats> EpipolarVoxelizer::voxelize(std::span<const GeometrySource> sources,
                                                  std::span<const EpipolarTransform> transforms,
                                                  EpipolarGrid& out) {
    auto made = rectify(sources, transforms, out);
    if (made)
        if (auto scanned = scan(out); !scanned)
            return scanned.error();
    return made;
}
Result<EpipolarStats> EpipolarVoxelizer::voxelize(std::span<const LightDepthMap> maps,
                                                  std::span<const EpipolarTransform> transforms,
                                                  EpipolarGrid& out) {
    auto made = rectify(maps, transforms, out);
    if (made)
        if (auto scanned = scan(out); !scanned)
            return scanned.error();
    return made;
}
Result<EpipolarStats> EpipolarVoxelizer::rectify(std::span<const GeometrySource> sources,
                                                 std::span<const EpipolarTransform> transforms,
                                                 EpipolarGrid& out) {
    return mImpl->fromGeometry(sources, transforms, out);
}
Result<EpipolarStats> EpipolarVoxelizer::rectify(std::span<const LightDepthMap> maps,
                                                 std::span<const EpipolarTransform> transforms,
                                                 EpipolarGrid& out) {
    return mImpl->fromMaps(maps, transforms, out);
}

std::uint64_t EpipolarVoxelizer::gpuBytes() const {
    return mImpl->depthMaps.texture().bytes();
}

Result<void> EpipolarVoxelizer::scan(EpipolarGrid& grid) {
    if (grid.transforms().empty())
        return Error{ErrorCode::InvalidArgument,
                     "epipolar scan: expected a grid with shadow volumes, found one without; "
                     "rectify or upload into it first"};
    if (auto own = checkOwn(*mImpl->device, grid); !own)
        return own;
    const auto program = mImpl->scanProgram();
    if (!program)
        return program.error();
    gl::DeviceState& device = *mImpl->device;
    const gl::DebugGroup group(device, "lamina: scan shadow volumes");
    const GladGLContext& gl = device.gl;
    const gl::ComputeStateGuard guard(device, 0, 1);
    const gl::TextureUnitGuard textures(device, LAMINA_EPIPOLAR_PASS_DEPTH_UNIT, 1);
    const gl::ImageUnitGuard images(device, LAMINA_EPIPOLAR_PASS_WORD_IMAGE + 1);
    const GLuint buffer = grid.buffer();
    gl.BindBuffersBase(GL_SHADER_STORAGE_BUFFER, LAMINA_EPIPOLAR_PASS_SPACE_BINDING, 1, &buffer);
    gl.BindImageTexture(LAMINA_EPIPOLAR_PASS_WORD_IMAGE, grid.texture(), 0, GL_TRUE, 0,
                        GL_READ_WRITE, GL_RGBA32UI);
    gl.UseProgram(*program);
    const std::uint32_t rows = grid.transforms().front().size().y;
    gl.DispatchCompute((rows + LAMINA_EPIPOLAR_SCAN_ROWS - 1) / LAMINA_EPIPOLAR_SCAN_ROWS,
                       grid.groupCount(), static_cast<GLuint>(grid.transforms().size()));
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                     GL_TEXTURE_UPDATE_BARRIER_BIT);
    return {};
}

} // namespace lamina
