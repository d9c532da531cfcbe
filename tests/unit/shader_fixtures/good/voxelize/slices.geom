#version 450 core
// permute SLICE_WORDS = 1 4
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

in VertexData {
    vec3 world;
} vertexIn[];

layout(location = 0) flat out int slice;

void main() {
    for (int i = 0; i < 3; ++i) {
        slice = int(vertexIn[i].world.z) * SLICE_WORDS;
        gl_Position = gl_in[i].gl_Position;
        EmitVertex();
    }
}
