#include "refraction/refraction_settings.hpp"

#include "refraction/check_enumeration.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace lamina {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kRightAngle = 1.5707964f;
constexpr std::uint32_t kMostEvents = 64;

struct Range {
    const char* what;
    float value;
    float low, high; ///< Inclusive; infinite: any finite value.
};

} // namespace

Result<void> checkSettings(const RefractionSettings& settings) {
    constexpr float kLeast = std::numeric_limits<float>::min();
    const Range ranges[] = {
        {"refractive index", settings.refractiveIndex, 1.0f, kGreatestIndex},
        {"reflection", settings.reflection, 0.0f, 1.0f},
        {"bend length", settings.bendLength, 0.0f, kInfinity},
        {"absorption", settings.absorption.x, 0.0f, kInfinity},
        {"absorption", settings.absorption.y, 0.0f, kInfinity},
        {"absorption", settings.absorption.z, 0.0f, kInfinity},
        {"body colour", settings.bodyColor.x, 0.0f, kInfinity},
        {"body colour", settings.bodyColor.y, 0.0f, kInfinity},
        {"body colour", settings.bodyColor.z, 0.0f, kInfinity},
        {"opaque length", settings.opaqueLength, kLeast, kInfinity},
        {"exponent", settings.exponent, kLeast, kInfinity},
        {"surface blur", settings.surfaceBlur, 0.0f, kInfinity},
        {"body blur", settings.bodyBlur, 0.0f, kInfinity},
        {"distance of what lies behind", settings.behindDistance, 0.0f, kInfinity},
        {"angle of the same surface", settings.sameSurfaceAngle, kLeast, kRightAngle},
    };
    for (const Range& range : ranges)
        if (!(range.value >= range.low && range.value <= range.high) ||
            !std::isfinite(range.value)) {
            const std::string upTo =
                std::isfinite(range.high) ? " to " + std::to_string(range.high) : " or more";
            return Error{ErrorCode::InvalidArgument, "refraction: expected a " +
                                                         std::string(range.what) + " of " +
                                                         std::to_string(range.low) + upTo +
                                                         ", found " + std::to_string(range.value)};
        }
    if (auto known = checkEnumeration("refraction", "AttenuationModel", settings.attenuation,
                                      AttenuationModel::Power);
        !known)
        return known;
    if (settings.maxEvents < 1 || settings.maxEvents > kMostEvents)
        return Error{ErrorCode::InvalidArgument, "refraction: expected 1 to 64 events, found " +
                                                     std::to_string(settings.maxEvents)};
    return {};
}

void writeSettings(const RefractionSettings& settings, RefractionModel model,
                   shared::LaminaRefractionConstants& block) {
    const bool isPower = settings.attenuation == AttenuationModel::Power;
    block.surface = {settings.refractiveIndex, settings.reflection, settings.bendLength,
                     settings.behindDistance};
    block.body = {isPower ? settings.bodyColor : settings.absorption, settings.exponent};
    block.blur = {settings.opaqueLength, settings.surfaceBlur, settings.bodyBlur,
                  std::cos(settings.sameSurfaceAngle)};
    block.modes.x = isPower ? LAMINA_REFRACTION_POWER : 0u;
    block.modes.w = model == RefractionModel::TwoSurfaces ? 1u : settings.maxEvents;
}

} // namespace lamina
