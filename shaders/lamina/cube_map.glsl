// Directions of a cube map's texels.
#ifndef LAMINA_CUBE_MAP_GLSL
#define LAMINA_CUBE_MAP_GLSL

// Direction, of any length, of a place in [0,1] x [0,1] of a face (OpenGL's order: +x, -x, +y, -y, +z, -z).
vec3 laminaCubeDirection(int face, vec2 place) {
    vec2 at = place * 2.0 - 1.0;
    switch (face) {
    case 0: return vec3(1.0, -at.y, -at.x);
    case 1: return vec3(-1.0, -at.y, at.x);
    case 2: return vec3(at.x, 1.0, at.y);
    case 3: return vec3(at.x, -1.0, -at.y);
    case 4: return vec3(at.x, -at.y, 1.0);
    default: return vec3(-at.x, -at.y, -1.0);
    }
}

#endif
