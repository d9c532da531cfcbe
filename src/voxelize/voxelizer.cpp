#include "voxelize/automatic_voxelizer.hpp"
#include "voxelize/overlap_voxelizer.hpp"
#include "voxelize/slicemap_calibration.hpp"
#include "voxelize/slicemap_voxelizer.hpp"
#include "voxelize/volume_bits_voxelizer.hpp"

#include "core/check_enumeration.hpp"
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

std::string_view name(SolidRule rule) {
    switch (rule) {
    case SolidRule::Parity:
        return "parity";
    case SolidRule::Voted:
        return "voted";
    case SolidRule::FloodFill:
        return "flood";
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

bool serves(Backend backend, const VoxelizerDesc& desc) {
    switch (desc.coverage) {
    case Coverage::Sampled:
        return isSlicemap(backend) || backend == Backend::Volume;
    case Coverage::Filled:
        return isSlicemap(backend);
    case Coverage::Conservative:
        return isSlicemap(backend) || backend == Backend::Overlap;
    case Coverage::Solid:
        return backend == Backend::Overlap ||
               (desc.solidRule == SolidRule::Parity &&
                (backend == Backend::Slicemap || backend == Backend::MrtSlicemap));
    case Coverage::Separating6:
        break;
    }
    return backend == Backend::Overlap;
}

/// Does it ask for rays or floods in all directions?
bool isByRule(const VoxelizerDesc& desc) {
    return desc.coverage == Coverage::Solid && desc.solidRule != SolidRule::Parity;
}

/// "solid coverage by rule voted"
std::string describeCoverage(const VoxelizerDesc& desc) {
    return std::string(name(desc.coverage)) + " coverage" +
           (isByRule(desc) ? " by rule " + std::string(name(desc.solidRule)) : "") +
           (desc.localRanges ? " with local ranges" : "");
}

/// What Backend::Automatic takes where there is no choice between grids.
Backend preferred(const VoxelizerDesc& desc) {
    return desc.localRanges || serves(Backend::MrtSlicemap, desc) ? Backend::MrtSlicemap
                                                                  : Backend::Overlap;
}

Error unsupported(const std::string& expected, const std::string& found) {
    return {ErrorCode::Unsupported, "voxelizer: expected " + expected + ", found " + found};
}

/// Are all values those of their enumerations?
Result<void> checkValues(const VoxelizerDesc& desc) {
    if (auto valid = checkEnumeration("voxelizer", "Backend", desc.backend, Backend::MrtSlicemap);
        !valid)
        return valid;
    if (auto valid = checkEnumeration("voxelizer", "Coverage", desc.coverage, Coverage::Solid);
        !valid)
        return valid;
    if (auto valid =
            checkEnumeration("voxelizer", "SolidRule", desc.solidRule, SolidRule::FloodFill);
        !valid)
        return valid;
    return checkEnumeration("voxelizer", "VoxelStore", desc.store.value_or(VoxelStore::Texture),
                            VoxelStore::Buffer);
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
    if (!serves(backend, desc)) {
        const Backend able =
            serves(Backend::MrtSlicemap, desc) ? Backend::MrtSlicemap : Backend::Overlap;
        VoxelizerDesc byParity = desc;
        byParity.solidRule = SolidRule::Parity;
        return unsupported("a backend that serves " + describeCoverage(desc),
                           asked + "; use Backend::Automatic or " + std::string(name(able)) +
                               (serves(backend, byParity)    ? ", or SolidRule::Parity"
                                : backend == Backend::Volume ? ", or coverage sampled"
                                                             : ", or coverage conservative") +
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

std::string automaticReason(const VoxelizerDesc& desc) {
    const char* why = "tests triangles against voxels exactly";
    if (desc.backend == Backend::MrtSlicemap)
        why =
            "decides per column, for every projection and slice distribution, up to 1024 slices a "
            "pass";
    else if (isByRule(desc))
        why = "looks from all sides";
    return std::string(name(desc.backend)) + " serves " + describeCoverage(desc) + ": it " + why;
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

Result<BitGrid> Voxelizer::downloadDoubtfulVoxels() const {
    return Error{ErrorCode::InvalidArgument,
                 "doubtful voxels: expected a voxelizer of solid coverage by SolidRule::Voted, "
                 "found another; ask for that rule first"};
}

Result<std::unique_ptr<Voxelizer>> Voxelizer::create(const Device& device,
                                                     const VoxelizerDesc& desc) {
    if (auto valid = checkValues(desc); !valid)
        return valid.error();
    const bool isAutomatic = desc.backend == Backend::Automatic;
    // Both serve: which one, the grid of each call decides.
    if (isAutomatic && !desc.localRanges && desc.store != VoxelStore::Texture &&
        serves(Backend::MrtSlicemap, desc) && serves(Backend::Overlap, desc))
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
    std::string reason = isAutomatic ? automaticReason(chosen)
                                     : std::string(name(chosen.backend)) + " was asked for";
    if (isMeasured)
        reason += "; the " + std::string(name(*chosen.store)) + " store was measured to be faster";
    (*created)->setReason(*device.state(), std::move(reason));
    return created;
}

} // namespace lamina
