// Layouts of the blocks and buffers of culled and clamped shadow volumes. Valid GLSL and C++.
#ifndef LAMINA_SHARED_SHADOW_VOLUMES_BLOCK
#define LAMINA_SHARED_SHADOW_VOLUMES_BLOCK

// Most layers that the view is cut into: the bits of a uvec4.
#define LAMINA_SHADOW_MAX_LAYERS 128

// Uniform buffer bindings.
#define LAMINA_SHADOW_FRAME_BINDING 0
#define LAMINA_SHADOW_DRAW_BINDING 1
// Storage buffer bindings.
#define LAMINA_SHADOW_BOUNDS_BINDING 0
#define LAMINA_SHADOW_SLICEMAP_BINDING 1
#define LAMINA_SHADOW_CASTER_BINDING 2
#define LAMINA_SHADOW_COMMAND_BINDING 3
#define LAMINA_SHADOW_RECEIVER_BINDING 4
#define LAMINA_SHADOW_QUERY_BINDING 5
#define LAMINA_SHADOW_STORAGE_BINDINGS 6
// Texture units.
#define LAMINA_SHADOW_DEPTH_UNIT 0
#define LAMINA_SHADOW_LIGHT_UNIT 1
#define LAMINA_SHADOW_EDGE_UNIT 2
#define LAMINA_SHADOW_BLOCKER_UNIT 0
#define LAMINA_SHADOW_STENCIL_UNIT 1
#define LAMINA_SHADOW_TEXTURE_UNITS 3

// Uniform location of the layer that an occlusion query asks for; the layer that stands for none.
#define LAMINA_SHADOW_QUERIED_LAYER 0
#define LAMINA_SHADOW_ANY_LAYER 0xffffffffu
// Of texels of the light's map without a caster.
#define LAMINA_SHADOW_NO_CASTER 0xffffffffu

// Invocations of the passes over the view's pixels, each way; of the one over the casters.
#define LAMINA_SHADOW_GROUP 16
#define LAMINA_SHADOW_CASTER_GROUP 64

// A texel of the light's map counts as touched within this distance of its centre, in texels: half its
// side, and as much again for half of that as the rounding of reconstructed points may need.
#define LAMINA_SHADOW_REACH 0.75

// LaminaShadowFrame.counts.w
#define LAMINA_SHADOW_CULL_CASTERS 1u
#define LAMINA_SHADOW_CLAMP 2u
#define LAMINA_SHADOW_DEPTH_TEST 4u
#define LAMINA_SHADOW_QUERIES 8u
// LaminaShadowDraw.draw.y
#define LAMINA_SHADOW_SHEET 1u
#define LAMINA_SHADOW_WHOLE 2u
#define LAMINA_SHADOW_CLIPPED 4u

// "Origin space" is world space less the view's origin, so that scenes far from the world's origin keep
// their precision.
struct LaminaShadowFrame {
    mat4 originToClip;
    mat4 windowToOrigin; // (pixel x, pixel y, depth, 1) to homogeneous origin space
    vec4 light;          // position, 1; or the unit direction towards the light, 0; origin space
    vec4 lightU;         // directional: unit axes across the light; unused
    vec4 lightV;
    vec4 layerAxis; // layer coordinate of a pixel = x * pixel.x + y * pixel.y + z; unused
    vec4 depth;     // background depth, 1 where depths grow with distance and -1 elsewhere, least, greatest
    vec4 bias;      // of visible depths: pixels of their slope, a constant, a share; unused
    uvec4 size;     // pixels in x and y, texels a side of the light's map, its faces
    uvec4 counts;   // layers, words a texel of the slicemap, casters, LAMINA_SHADOW_ flags
};

struct LaminaShadowDraw {
    mat4 localToOrigin;
    uvec4 draw; // index of the caster or receiver, LAMINA_SHADOW_ flags; unused
};

struct LaminaShadowCaster {
    uvec4 layers; // set bits: layers that the caster's volume is drawn in
    uvec4 state;  // 1 if the light sees a part of it, indices of its edges, indices of its triangles; unused
};

// As glDrawElementsIndirect reads it.
struct LaminaShadowCommand {
    uint count;
    uint instances;
    uint firstIndex;
    uint baseVertex;
    uint baseInstance;
};

#endif
