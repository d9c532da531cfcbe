#version 450 core
#include <lamina/outer.glsl>
layout(location = 0) out vec4 color;

void main() {
    color = vec4(outer(1.0));
}
