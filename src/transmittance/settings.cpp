#include "transmittance/settings.hpp"

#include "core/check_enumeration.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {
namespace {

/// Of a stand-in for log2(0): 2^(n * kNoLight) is 0 for every share of a leaf that matters.
constexpr float kNoLight = -1e4f;
constexpr double kLeafBias = 1.0 / 5000.0;
constexpr double kOpaqueBias = 1.0 / 1000.0;

Error invalid(const std::string& text) {
    return Error{ErrorCode::InvalidArgument, "transmittance: " + text};
}

} // namespace

Result<void> checkTransmittance(const TransmittanceDesc& desc) {
    if (auto valid = checkEnumeration("transmittance", "TransmittanceModel", desc.model,
                                      TransmittanceModel::Absorption);
        !valid)
        return valid;
    if (desc.maxFaces < 1 || desc.maxFaces > LAMINA_TRANSMITTANCE_MAX_FACES)
        return invalid("expected 1 to 6 faces, found " + std::to_string(desc.maxFaces));
    if (desc.size.x == 0 || desc.size.y == 0 || desc.size.z == 0)
        return invalid("expected at least one column each way and one slice, found " +
                       std::to_string(desc.size.x) + " x " + std::to_string(desc.size.y) + " x " +
                       std::to_string(desc.size.z));
    const bool isCount = desc.model == TransmittanceModel::LeafCount;
    if (desc.classes < 1 || desc.classes > LAMINA_TRANSMITTANCE_MAX_CLASSES)
        return invalid("expected 1 to 8 classes, found " + std::to_string(desc.classes));
    if (!isCount && (desc.classes > 1 || desc.localRanges))
        return invalid("expected one class and no local ranges of the absorption model, found " +
                       std::to_string(desc.classes) + " classes" +
                       (desc.localRanges ? " and local ranges" : ""));
    if (desc.opaqueMapTexels == 0)
        return invalid("expected an opaque shadow map of at least 1 texel, found 0");
    return {};
}

Result<void> checkTransmittance(NormalEncoding encoding) {
    return checkEnumeration("transmittance", "NormalEncoding", encoding, NormalEncoding::Unsigned);
}

Result<void> checkTransmittance(const TransmittanceSettings& settings) {
    if (auto valid =
            checkEnumeration("transmittance", "SliceLookup", settings.slices, SliceLookup::Linear);
        !valid)
        return valid;
    if (auto valid = checkEnumeration("transmittance", "AbsorptionForm", settings.absorptionForm,
                                      AbsorptionForm::Linear);
        !valid)
        return valid;
    for (const glm::vec3& sigma : settings.attenuation)
        for (int channel = 0; channel < 3; ++channel)
            if (!(sigma[channel] >= 0.0f && sigma[channel] <= 1.0f))
                return invalid("expected an attenuation in [0,1], found " +
                               std::to_string(sigma[channel]));
    for (const float width : {settings.filterWidth, settings.opaqueFilterWidth})
        if (!(width >= 0.0f && width <= kWidestFilter))
            return invalid("expected filter widths from 0 to 7, found " + std::to_string(width));
    if (settings.depthBias && !std::isfinite(*settings.depthBias))
        return invalid("expected a finite depth bias, found " +
                       std::to_string(*settings.depthBias));
    if (!(settings.absorptionScale >= 0.0f) || !std::isfinite(settings.absorptionScale))
        return invalid("expected a finite absorption scale of at least 0, found " +
                       std::to_string(settings.absorptionScale));
    return {};
}

shared::LaminaTransmittanceConstants
makeTransmittanceConstants(const TransmittanceDesc& desc, const TransmittanceSettings& settings,
                           const TransmittanceLight& light, const LightFaces& faces) {
    shared::LaminaTransmittanceConstants block{};
    // That of a point light is not checked, and not used.
    const glm::dvec3 direction = light.kind == LightKind::Point ? glm::dvec3(0.0, -1.0, 0.0)
                                                                : glm::normalize(light.direction);
    constexpr float kNoCone = -2.0f;
    block.light = light.kind == LightKind::Directional ? glm::vec4(glm::dvec4(-direction, 0.0))
                                                       : glm::vec4(glm::dvec4(light.position, 1.0));
    block.cone = {glm::vec3(direction), light.kind == LightKind::Spot
                                            ? static_cast<float>(std::cos(light.coneAngle))
                                            : kNoCone};
    double depths = 0.0;
    for (const GridTransform& grid : faces.grids)
        depths = std::max(depths, grid.farDepth() - grid.nearDepth());
    block.lookup = {settings.filterWidth, settings.opaqueFilterWidth,
                    settings.depthBias.value_or(static_cast<float>(kLeafBias * depths)),
                    settings.depthBias.value_or(static_cast<float>(kOpaqueBias * depths))};
    block.scalars.x = settings.absorptionScale;
    block.modes.x = desc.classes;
    if (settings.slices == SliceLookup::Linear)
        block.modes.y |= LAMINA_TRANSMITTANCE_LINEAR_SLICES;
    if (settings.absorptionForm == AbsorptionForm::Linear)
        block.modes.y |= LAMINA_TRANSMITTANCE_LINEAR_FORM;
    for (int axis = 0; axis < 6; ++axis)
        block.gridFaces[axis / 4][axis % 4] = faces.ofAxis[static_cast<std::size_t>(axis)];
    for (std::size_t i = 0; i < settings.attenuation.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            block.attenuation[i][channel] =
                std::max(std::log2(1.0f - settings.attenuation[i][channel]), kNoLight);
    return block;
}

} // namespace lamina
