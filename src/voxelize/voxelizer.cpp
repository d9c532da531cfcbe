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
    }
    return "unknown";
}

std::string_view name(Backend backend) {
    switch (backend) {
    case Backend::Automatic:
        return "auto";
    case Backend::Slicemap:
        return "slicemap";
    }
    return "unknown";
}

Result<std::unique_ptr<Voxelizer>> Voxelizer::create(const Device& device,
                                                     const VoxelizerDesc& desc) {
    auto created = createSlicemapVoxelizer(device, desc);
    if (!created)
        return created;
    std::string& reason = (*created)->mReason;
    reason =
        desc.backend == Backend::Automatic
            ? "slicemap serves " + std::string(name(desc.coverage)) + " coverage on every device"
            : std::string(name(desc.backend)) + " was asked for";
    device.state()->say(MessageSeverity::Info, "voxelizer: " + reason);
    return created;
}

} // namespace lamina
