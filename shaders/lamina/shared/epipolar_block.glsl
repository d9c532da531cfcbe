// Layout of the storage buffers that describe voxelized shadow volumes (std430). Valid GLSL and C++.
#ifndef LAMINA_SHARED_EPIPOLAR_BLOCK
#define LAMINA_SHARED_EPIPOLAR_BLOCK

// LaminaEpipolarSpace.size.w
#define LAMINA_EPIPOLAR_DIRECTIONAL 1u
#define LAMINA_EPIPOLAR_FULL_CIRCLE 2u

// LAMINA_EPIPOLAR_MAP: where the depths of the light come from.
#define LAMINA_EPIPOLAR_MAP_OWN 0
#define LAMINA_EPIPOLAR_MAP_2D 1
#define LAMINA_EPIPOLAR_MAP_ARRAY 2
#define LAMINA_EPIPOLAR_MAP_CUBE 3
#define LAMINA_EPIPOLAR_MAP_HEMISPHERE 4

// Faces of our own depth maps, by the axis they look along in the light's frame (u, v, light to eye).
#define LAMINA_EPIPOLAR_FACE_FRONT 0
#define LAMINA_EPIPOLAR_FACE_PLUS_U 1
#define LAMINA_EPIPOLAR_FACE_MINUS_U 2
#define LAMINA_EPIPOLAR_FACE_PLUS_V 3
#define LAMINA_EPIPOLAR_FACE_MINUS_V 4
#define LAMINA_EPIPOLAR_FACE_BACK 5

// Bindings of the rectify and scan kernels.
#define LAMINA_EPIPOLAR_PASS_SPACE_BINDING 0
#define LAMINA_EPIPOLAR_PASS_MAP_BINDING 1
#define LAMINA_EPIPOLAR_PASS_DEPTH_UNIT 0
#define LAMINA_EPIPOLAR_PASS_WORD_IMAGE 0

// Rows of a work group in the rectify kernel.
#define LAMINA_EPIPOLAR_RECTIFY_ROWS 4u

// Invocations that share a row, and rows of a work group, in the scan kernel.
#define LAMINA_EPIPOLAR_SCAN_RUNS 16
#define LAMINA_EPIPOLAR_SCAN_ROWS 4

// Most alpha samples of a voxelized shadow volume: a row of them fits the 32 KiB of shared memory that
// every device has.
#define LAMINA_EPIPOLAR_MAX_ALPHA 2048

// One voxelized shadow volume.
struct LaminaEpipolarSpace {
    // Eye in world space; distance from eye to light (0 for a directional light).
    vec4 eye;
    // Unit vector from eye to light; alpha below which the epipole rule holds (0: never).
    vec4 axis;
    // Unit vector of theta = 0; distance from which on the epipole rule takes a point to be lit.
    vec4 u;
    // axis x u; unused.
    vec4 v;
    // Least alpha, theta, phi; unused.
    vec4 origin;
    // Voxels per unit of alpha, theta, phi; unused.
    vec4 scale;
    // Voxels added to alpha, 0, to phi before a look-up; unused.
    vec4 bias;
    // Voxels along alpha, theta, phi; LAMINA_EPIPOLAR_* flags.
    uvec4 size;
    // First texel in x and y, phi samples in a texel (127 or 128), unused.
    uvec4 tile;
};

// Where the depths of one shadow volume's light are, for rectification.
struct LaminaEpipolarMap {
    // Own: window's low corner, texels per unit of it. Host: first texel and size of the part to use.
    vec4 window;
    // Own: near distance (point), or depth of 0 and depth range (directional), texels a side, unused.
    // Host: depth that means "nothing", cube: c and d of distance = c / (d + depth), texels a side.
    vec4 depth;
    // Direction of a spot's light in the frame (u, v, light to eye); cosine of its cone (-2: none).
    vec4 spot;
    // Own: layers of faces 0 to 3. Host array: layer, unused.
    ivec4 layers;
    // Own: layers of faces 4 and 5. Both: index of the LaminaEpipolarSpace, unused.
    ivec4 layersAndSpace;
    // Host: from positions relative to the eye, in the frame (u, v, axis), to texel x, y, depth; and back.
    // Cube and hemisphere: rotation from that frame to the map's axes; and back.
    mat4 toTexel;
    mat4 fromTexel;
};

#endif
