#include "voxelize/automatic_voxelizer.hpp"
#include "voxelize/overlap_voxelizer.hpp"
#include "voxelize/slicemap_calibration.hpp"
#include "voxelize/slicemap_voxelizer.hpp"
#include "voxelize/volume_bits_voxelizer.hpp"

#include "gl/device_state.hpp"

#include <lamina/voxelize/voxelizer.hpp>

namespace lamina {

std::string_view name(Coverage coverage) {
    switch (coverage) {
    case Coverage::Sampled:
        return "sampled";
    case Coverage::Filled:
        return "filled";
    case Coverage::Conservative:
        return "conservative";
    case Coverage::Separating6:
        return "separating6";
    case Coverage::Solid:
        return "solid";
    }
    return "unknown";
}

std::string_view name(Backend backend) {
    switch (backend) {
    case Backend::Automatic:
        return "auto";
    case Backend::Slicemap:
        return "slicemap";
    case Backend::Overlap:
        return "overlap";
    case Backend::Volume:
        return "volume";
    case Backend::LocalSlicemap:
        return "local_slicemap";
    case Backend::MrtSlicemap:
        return "mrt_slicemap";
    }
    return "unknown";
}

namespace {

bool isSlicemap(Backend backend) {
    return backend == Backend::Slicemap || backend == Backend::LocalSlicemap ||
           backend == Backend::MrtSlicemap;
}

bool serves(Backend backend, Coverage coverage) {
    switch (coverage) {
    case Coverage::Sampled:
        return isSlicemap(backend) || backend == Backend::Volume;
    case Coverage::Filled:
        return isSlicemap(backend);
    case Coverage::Conservative:
        return isSlicemap(backend) || backend == Backend::Overlap;
    case Coverage::Solid:
        return backend == Backend::Slicemap || backend == Backend::MrtSlicemap ||
               backend == Backend::Overlap;
    case Coverage::Separating6:
        break;
    }
    return backend == Backend::Overlap;
}

/// What Backend::Automatic takes where there is no choice between grids.
Backend preferred(const VoxelizerDesc& desc) {
    return desc.localRanges || serves(Backend::MrtSlicemap, desc.coverage) ? Backend::MrtSlicemap
                                                                           : Backend::Overlap;
}

Error unsupported(const std::string& expected, const std::string& found) {
    return {ErrorCode::Unsupported, "voxelizer: expected " + expected + ", found " + found};
}

/// Does the backend serve all that is asked?
Result<void> checkServed(Backend backend, const VoxelizerDesc& desc) {
    const std::string asked(name(backend));
    const std::string coverage(name(desc.coverage));
    const bool isLocal = desc.localRanges || backend == Backend::LocalSlicemap;
    if (isLocal && (desc.coverage == Coverage::Solid || desc.coverage == Coverage::Separating6))
        return unsupported("a coverage that slicemaps serve with local ranges",
                           coverage + "; use coverage conservative or filled, or uniform ranges by "
                                      "Backend::Automatic (overlap)");
    if (!serves(backend, desc.coverage)) {
        const Backend able =
            desc.coverage == Coverage::Separating6 ? Backend::Overlap : Backend::MrtSlicemap;
        return unsupported("a backend that serves " + coverage + " coverage",
                           asked + "; use Backend::Automatic or " + std::string(name(able)) +
                               ", or coverage " +
                               (backend == Backend::Volume ? "sampled" : "conservative") +
                               ", the nearest that " + asked + " serves");
    }
    if (desc.localRanges && backend != Backend::LocalSlicemap && backend != Backend::MrtSlicemap)
        return unsupported("a backend with local ranges",
                           asked + "; use local_slicemap or mrt_slicemap");
    const VoxelStore own = backend == Backend::Overlap ? VoxelStore::Buffer : VoxelStore::Texture;
    if (desc.store && *desc.store != own && backend != Backend::MrtSlicemap)
        return unsupported("the " + std::string(name(own)) + " store, which " + asked + " writes",
                           std::string(name(*desc.store)) +
                               "; leave VoxelizerDesc::store empty or use mrt_slicemap");
    return {};
}

/// desc.backend is not Automatic.
Result<std::unique_ptr<Voxelizer>> createBackend(const Device& device, const VoxelizerDesc& desc) {
    switch (desc.backend) {
    case Backend::Overlap:
        return createOverlapVoxelizer(device, desc);
    case Backend::Volume:
        return createVolumeBitsVoxelizer(device, desc);
    default:
        return createSlicemapVoxelizer(device, desc);
    }
}

std::string automaticReason(Backend backend, Coverage coverage) {
    return std::string(name(backend)) + " serves " + std::string(name(coverage)) +
           " coverage: it " +
           (backend == Backend::MrtSlicemap ? "decides per column, for every projection and slice "
                                              "distribution, up to 1024 slices a pass"
                                            : "tests triangles against voxels exactly");
}

} // namespace

Result<SolidReport> Voxelizer::downloadSolidReport() const {
    return Error{ErrorCode::InvalidArgument,
                 "solid report: expected a voxelizer of solid coverage that has voxelized, found "
                 "none; voxelize with Coverage::Solid first"};
}

Result<VoxelizeStats> Voxelizer::voxelizeWith(std::span<const GeometrySource>, const GridTransform&,
                                              const VoxelizeOptions&, std::span<VoxelGrid>) {
    return Error{ErrorCode::Unsupported,
                 "voxelize: expected a slicemap backend for splits and bounding geometry, found " +
                     std::string(name(backend())) + "; use voxelize(), or create mrt_slicemap"};
}

void Voxelizer::setReason(gl::DeviceState& device, std::string reason) {
    mReason = std::move(reason);
    device.say(MessageSeverity::Info, "voxelizer: " + mReason);
}

Result<std::unique_ptr<Voxelizer>> Voxelizer::create(const Device& device,
                                                     const VoxelizerDesc& desc) {
    const bool isAutomatic = desc.backend == Backend::Automatic;
    // Both serve: which one, the grid of each call decides.
    if (isAutomatic && !desc.localRanges && !desc.store &&
        serves(Backend::MrtSlicemap, desc.coverage) && serves(Backend::Overlap, desc.coverage))
        return createAutomaticVoxelizer(device, desc);
    VoxelizerDesc chosen = desc;
    if (isAutomatic)
        chosen.backend = preferred(desc);
    if (auto served = checkServed(chosen.backend, chosen); !served)
        return served.error();
    const bool isMeasured = chosen.backend == Backend::MrtSlicemap && !isAutomatic && !chosen.store;
    if (isMeasured)
        chosen.store = fasterSlicemapStore(device);
    auto created = createBackend(device, chosen);
    if (!created)
        return created;
    std::string reason = isAutomatic ? automaticReason(chosen.backend, desc.coverage)
                                     : std::string(name(chosen.backend)) + " was asked for";
    if (isMeasured)
        reason += "; the " + std::string(name(*chosen.store)) + " store was measured to be faster";
    (*created)->setReason(*device.state(), std::move(reason));
    return created;
}

} // namespace lamina
