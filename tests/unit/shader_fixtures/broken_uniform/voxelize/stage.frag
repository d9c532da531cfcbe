#version 450 core
layout(std140, binding = 0) uniform Grid { vec4 transform; };
layout(location = 0) out vec4 color;

void main() {
    color = transform;
}
