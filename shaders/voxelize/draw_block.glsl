// The constants of one draw of a voxelization pass.
#include <lamina/shared/grid_block.glsl>

layout(std140, binding = LAMINA_DRAW_BLOCK_BINDING) uniform LaminaDrawBlock {
    LaminaDrawConstants laminaDraw;
};
