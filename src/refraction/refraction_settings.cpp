#include "refraction/refraction_settings.hpp"

#include "core/check_enumeration.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace lamina {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Of values that are above 0.
constexpr float kLeast = std::numeric_limits<float>::min();
constexpr float kRightAngle = 1.5707964f;
constexpr std::uint32_t kMostEvents = 64;

struct Range {
    const char* what;
    float value;
    float low, high; ///< Inclusive; infinite: any finite value.
};

/// "a reflection of 0.000000 to 1.000000", "a finite exponent above 0"
std::string describe(const Range& range) {
    const bool isBounded = std::isfinite(range.high);
    const bool isVowel = std::string_view("aeo").find(range.what[0]) != std::string_view::npos;
    const std::string what = (!isBounded ? "a finite "
                              : isVowel  ? "an "
                                         : "a ") +
                             std::string(range.what);
    const std::string high = std::to_string(range.high);
    if (range.low == kLeast)
        return what + " above 0" + (isBounded ? ", at most " + high : "");
    return what + " of " + std::to_string(range.low) + (isBounded ? " to " + high : " or more");
}

} // namespace

Result<void> checkSettings(const RefractionSettings& settings) {
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
            return Error{ErrorCode::InvalidArgument, "refraction: expected " + describe(range) +
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
