#version 450 core
// permute INVERT = 0 1
layout(location = 0) out vec4 color;

void main() {
    color = vec4(1.0);
#if INVERT
    color = vec3(0.0);
#endif
}
