// The uniform blocks of the volume passes.
#include <lamina/shared/volume_block.glsl>

layout(std140, binding = LAMINA_DRAW_BLOCK_BINDING) uniform LaminaVolumeDrawBlock {
    LaminaVolumeDrawConstants laminaDraw;
};

layout(std140, binding = LAMINA_PASS_GRID_BLOCK_BINDING) uniform LaminaPassVolumeBlock {
    LaminaVolumeConstants constants;
    vec4 boundaries[LAMINA_MAX_SLICE_BOUNDARIES / 4];
} laminaPassVolume;

layout(std140, binding = LAMINA_VOLUME_MATERIAL_BLOCK_BINDING) uniform LaminaMaterialBlock {
    LaminaMaterialConstants laminaMaterials[LAMINA_MAX_MATERIALS];
};

vec3 laminaNormalToWorld(vec3 normal) {
    return vec3(dot(laminaDraw.normalToWorld[0].xyz, normal), dot(laminaDraw.normalToWorld[1].xyz, normal),
                dot(laminaDraw.normalToWorld[2].xyz, normal));
}

// Is a payload asked for?
bool laminaAsks(uint payload) {
    return (laminaDraw.pass.w & payload) != 0u;
}

// Ids past the table's end use its last material.
LaminaMaterialConstants laminaMaterialOf(uint id) {
    return laminaMaterials[min(id, uint(laminaDraw.settings.z))];
}
