#include "voxelize/automatic_voxelizer.hpp"
#include "voxelize/overlap_voxelizer.hpp"
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
    }
    return "unknown";
}

namespace {

bool serves(Backend backend, Coverage coverage) {
    switch (coverage) {
    case Coverage::Sampled:
        return backend == Backend::Slicemap || backend == Backend::Volume;
    case Coverage::Filled:
        return backend == Backend::Slicemap;
    case Coverage::Conservative:
    case Coverage::Solid:
        return backend == Backend::Slicemap || backend == Backend::Overlap;
    case Coverage::Separating6:
        break;
    }
    return backend == Backend::Overlap;
}

Result<std::unique_ptr<Voxelizer>> createBackend(const Device& device, const VoxelizerDesc& desc,
                                                 Backend backend) {
    switch (backend) {
    case Backend::Overlap:
        return createOverlapVoxelizer(device, desc);
    case Backend::Volume:
        return createVolumeBitsVoxelizer(device, desc);
    default:
        return createSlicemapVoxelizer(device, desc);
    }
}

} // namespace

Result<SolidReport> Voxelizer::downloadSolidReport() const {
    return Error{ErrorCode::InvalidArgument,
                 "solid report: expected a voxelizer of solid coverage that has voxelized, found "
                 "none; voxelize with Coverage::Solid first"};
}

void Voxelizer::setReason(gl::DeviceState& device, std::string reason) {
    mReason = std::move(reason);
    device.say(MessageSeverity::Info, "voxelizer: " + mReason);
}

Result<std::unique_ptr<Voxelizer>> Voxelizer::create(const Device& device,
                                                     const VoxelizerDesc& desc) {
    const std::string coverage(name(desc.coverage));
    const std::string asked(name(desc.backend));
    const Backend only =
        serves(Backend::Slicemap, desc.coverage) ? Backend::Slicemap : Backend::Overlap;
    if (desc.backend == Backend::Automatic) {
        if (serves(Backend::Slicemap, desc.coverage) && serves(Backend::Overlap, desc.coverage))
            return createAutomaticVoxelizer(device, desc);
        auto created = createBackend(device, desc, only);
        if (created)
            (*created)->setReason(
                *device.state(),
                std::string(name(only)) + " serves " + coverage + " coverage: it " +
                    (only == Backend::Slicemap
                         ? "decides per column centre, for every projection and slice distribution"
                         : "tests triangles against voxels exactly"));
        return created;
    }
    if (!serves(desc.backend, desc.coverage))
        return Error{ErrorCode::Unsupported,
                     "voxelizer: expected a backend that serves " + coverage + " coverage, found " +
                         asked + "; use Backend::Automatic or " + std::string(name(only)) +
                         ", or coverage " +
                         (desc.backend == Backend::Volume ? "sampled" : "conservative") +
                         ", the nearest that " + asked + " serves"};
    auto created = createBackend(device, desc, desc.backend);
    if (created)
        (*created)->setReason(*device.state(), asked + " was asked for");
    return created;
}

} // namespace lamina
