#include "voxelize/volume_formats.hpp"

#include "voxelize/volume_constants.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace lamina {
namespace {

std::string_view payloadName(VolumePayload payload) {
    constexpr std::array<std::string_view, kVolumePayloadCount> kNames = {
        "hit counts", "absorption", "normals", "colours", "optics"};
    return kNames[indexOf(payload)];
}

std::string_view allowedFormats(VolumePayload payload) {
    switch (payload) {
    case VolumePayload::Count:
        return "R8 or R32UI";
    case VolumePayload::Absorption:
        return "R8, R16F or R32F";
    default:
        return "RGBA8, RGBA16F or RGBA32F";
    }
}

bool isAllowed(VolumePayload payload, VolumeFormat format) {
    switch (payload) {
    case VolumePayload::Count:
        return format == VolumeFormat::R8 || format == VolumeFormat::R32UI;
    case VolumePayload::Absorption:
        return format == VolumeFormat::R8 || format == VolumeFormat::R16F ||
               format == VolumeFormat::R32F;
    default:
        return format == VolumeFormat::RGBA8 || format == VolumeFormat::RGBA16F ||
               format == VolumeFormat::RGBA32F;
    }
}

std::uint32_t payloadBit(VolumePayload payload, VolumeFormat format) {
    switch (payload) {
    case VolumePayload::Count:
        return format == VolumeFormat::R8 ? LAMINA_VOLUME_COUNT_R8 : LAMINA_VOLUME_COUNT_R32UI;
    case VolumePayload::Absorption:
        return LAMINA_VOLUME_ABSORPTION;
    case VolumePayload::Normal:
        return LAMINA_VOLUME_NORMAL;
    case VolumePayload::Color:
        return LAMINA_VOLUME_COLOR;
    case VolumePayload::Optics:
        return LAMINA_VOLUME_OPTICS;
    }
    return 0;
}

std::uint64_t hitCeiling(VolumePayload payload, VolumeFormat format) {
    switch (accumulationFormat(payload, format)) {
    case VolumeFormat::R8:
        return 255;
    case VolumeFormat::R16F:
    case VolumeFormat::RGBA16F:
        return 2048;
    case VolumeFormat::R32F:
    case VolumeFormat::RGBA32F:
        return 1u << 24;
    default:
        return std::numeric_limits<std::uint32_t>::max();
    }
}

} // namespace

VolumeFormatInfo info(VolumeFormat format) {
    switch (format) {
    case VolumeFormat::None:
        return {"None", GL_NONE, 0, 0};
    case VolumeFormat::R8:
        return {"R8", GL_R8, 1, 1};
    case VolumeFormat::R16F:
        return {"R16F", GL_R16F, 2, 1};
    case VolumeFormat::R32F:
        return {"R32F", GL_R32F, 4, 1};
    case VolumeFormat::R32UI:
        return {"R32UI", GL_R32UI, 4, 1};
    case VolumeFormat::RGBA8:
        return {"RGBA8", GL_RGBA8, 4, 4};
    case VolumeFormat::RGBA16F:
        return {"RGBA16F", GL_RGBA16F, 8, 4};
    case VolumeFormat::RGBA32F:
        return {"RGBA32F", GL_RGBA32F, 16, 4};
    }
    return {"unknown", GL_NONE, 0, 0};
}

VolumeFormat VolumeLayout::format(VolumePayload payload) const {
    switch (payload) {
    case VolumePayload::Count:
        return count;
    case VolumePayload::Absorption:
        return absorption;
    case VolumePayload::Normal:
        return normal;
    case VolumePayload::Color:
        return color;
    case VolumePayload::Optics:
        return optics;
    }
    return VolumeFormat::None;
}

Result<void> checkLayout(const VolumeLayout& layout) {
    bool holdsSomething = false;
    for (const VolumePayload payload : kVolumePayloads) {
        const VolumeFormat format = layout.format(payload);
        if (format == VolumeFormat::None)
            continue;
        holdsSomething = true;
        if (!isAllowed(payload, format))
            return Error{ErrorCode::InvalidArgument,
                         "volume: expected " + std::string(allowedFormats(payload)) + " for " +
                             std::string(payloadName(payload)) + ", found " +
                             std::string(info(format).name)};
    }
    if (!holdsSomething)
        return Error{ErrorCode::InvalidArgument,
                     "volume: expected a format for at least one payload, found None for all"};
    return {};
}

bool isResolved(VolumePayload payload, VolumeFormat format) {
    return format == VolumeFormat::RGBA8 ||
           (format == VolumeFormat::R8 && payload != VolumePayload::Count);
}

VolumeFormat accumulationFormat(VolumePayload payload, VolumeFormat format) {
    if (!isResolved(payload, format))
        return format;
    return format == VolumeFormat::R8 ? VolumeFormat::R16F : VolumeFormat::RGBA16F;
}

std::uint32_t payloadBits(const VolumeLayout& layout) {
    std::uint32_t bits = 0;
    for (const VolumePayload payload : kVolumePayloads)
        if (layout.format(payload) != VolumeFormat::None)
            bits |= payloadBit(payload, layout.format(payload));
    return bits;
}

std::uint32_t resolvedBits(const VolumeLayout& layout) {
    std::uint32_t bits = 0;
    for (const VolumePayload payload : kVolumePayloads)
        if (isResolved(payload, layout.format(payload)))
            bits |= payloadBit(payload, layout.format(payload));
    return bits;
}

std::uint64_t hitCeiling(const VolumeLayout& layout) {
    std::uint64_t ceiling = std::numeric_limits<std::uint32_t>::max();
    for (const VolumePayload payload : kVolumePayloads)
        if (layout.format(payload) != VolumeFormat::None)
            ceiling = std::min(ceiling, hitCeiling(payload, layout.format(payload)));
    return ceiling;
}

} // namespace lamina
