#version 450 core
layout(location = 0) in vec3 position;

out VertexData {
    vec3 world;
} vertexOut;

void main() {
    vertexOut.world = position;
    gl_Position = vec4(position, 1.0);
}
