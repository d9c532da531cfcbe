#include "voxelize/volume_draw.hpp"

#include "voxelize/volume_formats.hpp"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace lamina {
namespace {

constexpr std::uint32_t kLayersOfFirstPass = LAMINA_VOLUME_LAYERS_PER_INVOCATION;
constexpr std::uint32_t kLayersOfLaterPasses =
    LAMINA_VOLUME_LAYERS_PER_INVOCATION * LAMINA_VOLUME_INVOCATIONS_OF_LATER_PASSES;

/// Does a front face turn clockwise in column space? It turns counter-clockwise where x, y and the
/// direction towards the camera form a right-handed system.
bool isMirrored(const GridTransform& transform) {
    return glm::determinant(glm::dmat3(transform.worldToColumn())) > 0.0;
}

} // namespace

Result<void> checkMaterials(std::span<const Material> materials) {
    if (materials.size() > std::size_t{LAMINA_MAX_MATERIALS})
        return Error{ErrorCode::InvalidArgument,
                     "voxelize: expected at most " +
                         std::to_string(std::size_t{LAMINA_MAX_MATERIALS}) + " materials, found " +
                         std::to_string(materials.size()) + "; share materials among sources"};
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const Material& material = materials[i];
        const auto invalid = [i](const char* expected, float found) {
            return Error{ErrorCode::InvalidArgument, "voxelize: material " + std::to_string(i) +
                                                         ": expected " + expected + ", found " +
                                                         std::to_string(found)};
        };
        if (!(material.absorption >= 0.0f && std::isfinite(material.absorption)))
            return invalid("a finite absorption of at least 0", material.absorption);
        if (!(material.refractiveIndex >= 1.0f && std::isfinite(material.refractiveIndex)))
            return invalid("a finite refractive index of at least 1", material.refractiveIndex);
        if (!(material.transmission >= 0.0f && material.transmission <= 1.0f))
            return invalid("a transmission in [0,1]", material.transmission);
        for (int channel = 0; channel < 4; ++channel)
            if (!(material.color[channel] >= 0.0f && material.color[channel] <= 1.0f))
                return invalid("a colour in [0,1]", material.color[channel]);
    }
    return {};
}

shared::LaminaMaterialConstants materialConstants(const Material& material) {
    const auto facing = [&] {
        switch (material.orientation) {
        case OrientationRule::FrontFaces:
            return LAMINA_FACING_FRONT;
        case OrientationRule::BackFaces:
            return LAMINA_FACING_BACK;
        case OrientationRule::TwoSided:
            break;
        }
        return LAMINA_FACING_ANY;
    }();
    return {material.color,
            {material.absorption, material.refractiveIndex, material.transmission,
             static_cast<float>(facing)}};
}

shared::LaminaVolumeDrawConstants volumeDrawConstants(const GridTransform& transform,
                                                      const VolumeLayout& layout,
                                                      const VolumeVoxelizerDesc& desc,
                                                      std::size_t materialCount,
                                                      std::uint32_t subpixelBits) {
    shared::LaminaVolumeDrawConstants constants{};
    const double near = transform.nearDepth();
    const double far = transform.farDepth();
    constants.depthRange = {near, 1.0 / (far - near), near * LAMINA_EYE_CUT, far};
    constants.size = {transform.size(), gridFlags(transform)};
    constants.pass = {0, 0, isMirrored(transform) ? 1 : 0, payloadBits(layout)};
    // Twice the rasterizer's snapping distance, and the rounding of normalized device coordinates.
    const auto columns = static_cast<float>(std::max(transform.size().x, transform.size().y));
    const float dilation =
        2.0f * std::ldexp(1.0f, -static_cast<int>(subpixelBits)) + columns * 0x1p-22f;
    constants.settings = {dilation, desc.slabOverlap, static_cast<float>(materialCount - 1), 0.0f};
    return constants;
}

glm::dmat3 cofactors(const glm::dmat3& matrix) {
    return {glm::cross(matrix[1], matrix[2]), glm::cross(matrix[2], matrix[0]),
            glm::cross(matrix[0], matrix[1])};
}

glm::dmat3 normalMatrix(const glm::dmat4& localToWorld) {
    // Cofactors exist for singular matrices too; a mirror's turn normals.
    const glm::dmat3 linear(localToWorld);
    return cofactors(linear) * (glm::determinant(linear) < 0.0 ? -1.0 : 1.0);
}

void setTransform(shared::LaminaVolumeDrawConstants& constants, const GridTransform& transform,
                  const glm::dmat4& localToWorld) {
    const glm::dmat4 columnRows = glm::transpose(transform.worldToColumn() * localToWorld);
    const double turn = glm::determinant(glm::dmat3(localToWorld)) < 0.0 ? -1.0 : 1.0;
    const glm::dmat3 normalRows = glm::transpose(normalMatrix(localToWorld));
    for (int row = 0; row < 3; ++row) {
        constants.localToColumn[row] = columnRows[row];
        constants.normalToWorld[row] = glm::vec4(glm::vec3(normalRows[row]), turn);
    }
}

std::uint32_t volumePassCount(const GridTransform& transform) {
    // The eye may cut a triangle into two parts, each with layers of its own.
    const std::uint32_t parts = transform.projection() == Projection::Perspective ? 2 : 1;
    const std::uint32_t most = transform.size().z * parts;
    if (most <= kLayersOfFirstPass)
        return 1;
    return 1 + (most - kLayersOfFirstPass + kLayersOfLaterPasses - 1) / kLayersOfLaterPasses;
}

std::uint32_t firstLayerOf(std::uint32_t pass) {
    return pass == 0 ? 0 : kLayersOfFirstPass + (pass - 1) * kLayersOfLaterPasses;
}

} // namespace lamina
