#include "voxelize/overlap_voxelizer.hpp"
#include "voxelize/slicemap_voxelizer.hpp"

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
    }
    return "unknown";
}

namespace {

/// The backend that serves a coverage, and why it and no other.
struct Choice {
    Backend backend;
    std::string_view why;
};

Choice choose(Coverage coverage) {
    switch (coverage) {
    case Coverage::Sampled:
    case Coverage::Filled:
        return {Backend::Slicemap,
                "it decides per column centre, for every projection and slice distribution"};
    case Coverage::Conservative:
    case Coverage::Separating6:
        return {Backend::Overlap, "it tests triangles against voxels exactly"};
    case Coverage::Solid:
        break;
    }
    return {Backend::Overlap, "it counts crossings exactly, in one pass of the geometry"};
}

} // namespace

Result<SolidReport> Voxelizer::downloadSolidReport() const {
    return Error{ErrorCode::InvalidArgument,
                 "solid report: expected a voxelizer of solid coverage that has voxelized, found "
                 "none; voxelize with Coverage::Solid first"};
}

Result<std::unique_ptr<Voxelizer>> Voxelizer::create(const Device& device,
                                                     const VoxelizerDesc& desc) {
    const Choice choice = choose(desc.coverage);
    const std::string coverage(name(desc.coverage));
    const std::string chosen(name(choice.backend));
    if (desc.backend != Backend::Automatic && desc.backend != choice.backend)
        return Error{ErrorCode::Unsupported,
                     "voxelizer: expected a backend that serves " + coverage + " coverage, found " +
                         std::string(name(desc.backend)) + "; use Backend::Automatic or " + chosen +
                         ", or coverage " +
                         (desc.backend == Backend::Overlap ? "conservative" : "filled") +
                         ", the nearest that " + std::string(name(desc.backend)) + " serves"};
    auto created = choice.backend == Backend::Overlap ? createOverlapVoxelizer(device, desc)
                                                      : createSlicemapVoxelizer(device, desc);
    if (!created)
        return created;
    std::string& reason = (*created)->mReason;
    reason = desc.backend == Backend::Automatic
                 ? chosen + " serves " + coverage + " coverage: " + std::string(choice.why)
                 : chosen + " was asked for";
    device.state()->say(MessageSeverity::Info, "voxelizer: " + reason);
    return created;
}

} // namespace lamina
