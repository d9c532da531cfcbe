// The engine's view in a shader: the world point of a pixel and back (lamina/gl/view.hpp).
//
// Functions of a LaminaViewConstants, wherever the includer keeps it. Pixels are window coordinates as
// in gl_FragCoord.xy: pixel centres are at half integers. Depths are those of the depth buffer.
//
// Precision: single, relative to the view's origin, so that scenes far from the world's origin lose
// nothing but the rounding of the result.
#ifndef LAMINA_VIEW_GLSL
#define LAMINA_VIEW_GLSL

#include <lamina/shared/view_block.glsl>

// World point seen at a pixel with this depth.
vec3 laminaWorldPoint(LaminaViewConstants view, vec2 pixel, float depth) {
    vec4 point = view.windowToWorld * vec4(pixel, depth, 1.0);
    return view.origin.xyz + point.xyz / point.w;
}

// Pixel x, y and depth of a world point, and w: negative or 0 behind the viewer.
vec4 laminaWindowPoint(LaminaViewConstants view, vec3 world) {
    vec4 point = view.worldToWindow * vec4(world - view.origin.xyz, 1.0);
    return vec4(point.xyz / point.w, point.w);
}

// Does a pixel of this depth show no surface?
bool laminaIsBackground(LaminaViewConstants view, float depth) {
    return depth == view.origin.w;
}

// Unit vector from a world point towards the viewer.
vec3 laminaTowardsViewer(LaminaViewConstants view, vec3 world) {
    return normalize(view.viewpoint.xyz - view.viewpoint.w * world);
}

#endif
