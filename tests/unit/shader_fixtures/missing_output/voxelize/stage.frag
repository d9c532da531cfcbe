#version 450 core
layout(location = 0) out vec4 color;
layout(location = 1) in vec4 shade;
layout(location = 2) in vec4 unused;

void main() {
    color = shade;
}
