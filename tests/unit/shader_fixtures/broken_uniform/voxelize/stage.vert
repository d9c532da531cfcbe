#version 450 core
layout(std140, binding = 0) uniform Grid { mat4 transform; };

void main() {
    gl_Position = transform[0];
}
