#version 450 core
layout(location = 0) in vec3 position;
out vec3 normal;

void main() {
    normal = position;
    gl_Position = vec4(position, 1.0);
}
