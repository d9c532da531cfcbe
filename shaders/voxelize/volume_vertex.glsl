// main() of the vertex stage of the volume backend: runs the source's laminaVertex() and moves its
// position to column space in double precision.
#include <lamina/vertex_interface.glsl>
#include <voxelize/volume_blocks.glsl>

out LaminaVolumeVertex {
    dvec3 column; // column x * w, column y * w, depth
    vec3 local;
    vec3 normal; // World space, any length; zero if unknown.
    vec4 color;
    uint material;
    uint vertex;
} laminaStage;

LaminaVertex laminaVertex();

void main() {
    LaminaVertex vertex = laminaVertex();
    dvec4 position = dvec4(dvec3(vertex.position), 1.0lf);
    laminaStage.column = dvec3(dot(laminaDraw.localToColumn[0], position),
                               dot(laminaDraw.localToColumn[1], position),
                               dot(laminaDraw.localToColumn[2], position));
    laminaStage.local = vertex.position;
    laminaStage.normal = laminaNormalToWorld(vertex.normal);
    laminaStage.color = laminaVertexColor;
    laminaStage.material = vertex.material;
    laminaStage.vertex = uint(gl_VertexID);
}
