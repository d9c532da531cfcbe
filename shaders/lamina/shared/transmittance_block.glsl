// Layout of the uniform block of transmittance shadows (std140), and its bindings. Valid GLSL and C++.
#ifndef LAMINA_SHARED_TRANSMITTANCE_BLOCK
#define LAMINA_SHARED_TRANSMITTANCE_BLOCK

// LAMINA_TRANSMITTANCE_MODEL
#define LAMINA_TRANSMITTANCE_LEAF_COUNT 0
#define LAMINA_TRANSMITTANCE_ABSORPTION 1

// LaminaTransmittanceConstants.modes.y
#define LAMINA_TRANSMITTANCE_LINEAR_SLICES 1u
#define LAMINA_TRANSMITTANCE_OPAQUE_MAP 2u
#define LAMINA_TRANSMITTANCE_LINEAR_FORM 4u

#define LAMINA_TRANSMITTANCE_MAX_CLASSES 8
#define LAMINA_TRANSMITTANCE_MAX_FACES 6

// After LAMINA_TRANSMITTANCE_BLOCK_BINDING: our block, then the grids' blocks.
#define LAMINA_TRANSMITTANCE_GRID_BLOCKS 1
// After LAMINA_TRANSMITTANCE_TEXTURE_UNIT: the opaque map, the sums of absorption (no texture with
// LAMINA_TRANSMITTANCE_LEAF_COUNT), the grids' words, their near/far maps.
#define LAMINA_TRANSMITTANCE_OPAQUE_UNIT 0
#define LAMINA_TRANSMITTANCE_SUM_UNIT 1
#define LAMINA_TRANSMITTANCE_WORD_UNIT 2

// Bindings of apply(): the engine's view, then what the include reads; depths and normals likewise.
#define LAMINA_TRANSMITTANCE_APPLY_VIEW_BINDING 0
#define LAMINA_TRANSMITTANCE_APPLY_BLOCK_BINDING 1
#define LAMINA_TRANSMITTANCE_APPLY_DEPTH_UNIT 0
#define LAMINA_TRANSMITTANCE_APPLY_NORMAL_UNIT 1
#define LAMINA_TRANSMITTANCE_APPLY_TEXTURE_UNIT 2

// LAMINA_TRANSMITTANCE_NORMALS of apply().
#define LAMINA_TRANSMITTANCE_NORMALS_FROM_DEPTH 0
#define LAMINA_TRANSMITTANCE_NORMALS_SIGNED 1
#define LAMINA_TRANSMITTANCE_NORMALS_UNSIGNED 2

struct LaminaTransmittanceConstants {
    // Position of the light, 1; or the unit direction towards a directional light, 0.
    vec4 light;
    // Unit direction in which a spot shines, cosine of its cone (-2: no cone).
    vec4 cone;
    // Width of the columns' filter, of the opaque map's; depth bias of leaves, of opaque casters.
    vec4 lookup;
    // Absorption scale; depth of the opaque map where nothing is; 1 if its nearer depths are less, -1
    // if they are greater; unused.
    vec4 scalars;
    // Classes, LAMINA_TRANSMITTANCE_* flags, texels of the opaque map in x and y.
    uvec4 modes;
    // Face of the grids, and layer of the opaque map, that see +x, -x, +y, -y; then +z, -z. -1: none.
    ivec4 gridFaces[2];
    ivec4 opaqueLayers[2];
    // log2(1 - sigma) of each class in red, green and blue; unused.
    vec4 attenuation[LAMINA_TRANSMITTANCE_MAX_CLASSES];
    // World space to (texel x, texel y, depth in the map), homogeneous, of each layer of the opaque map.
    mat4 worldToOpaque[LAMINA_TRANSMITTANCE_MAX_FACES];
};

#endif
