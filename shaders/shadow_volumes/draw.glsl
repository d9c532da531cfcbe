// The constants of one draw.
#include <shadow_volumes/frame.glsl>

layout(std140, binding = LAMINA_SHADOW_DRAW_BINDING) uniform LaminaShadowDrawBlock {
    LaminaShadowDraw laminaDraw;
};
