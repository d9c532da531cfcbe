// Layout of the uniform block that describes the engine's view (std140). Valid GLSL and C++.
#ifndef LAMINA_SHARED_VIEW_BLOCK
#define LAMINA_SHARED_VIEW_BLOCK

struct LaminaViewConstants {
    // From (pixel x, pixel y, depth in the buffer, 1) to homogeneous world space relative to `origin`.
    mat4 windowToWorld;
    // From world space relative to `origin` to (pixel x, pixel y, depth in the buffer), homogeneous.
    mat4 worldToWindow;
    // Viewpoint in world space, 1; or the direction towards the viewer of an orthographic view, 0.
    vec4 viewpoint;
    // A world point near what the view shows, background depth.
    vec4 origin;
    // Pixels in x and y; unused.
    uvec4 size;
};

#endif
