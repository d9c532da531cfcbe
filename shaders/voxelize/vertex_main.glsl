// main() of the vertex stage of every raster backend: runs the source's laminaVertex() and moves its
// position to column space in double precision, so that voxel coordinates carry no float rounding.
// LAMINA_SPLIT 1: the material goes along.
#include <lamina/vertex_interface.glsl>
#include <voxelize/draw_block.glsl>

out LaminaVertexStage {
    dvec3 column; // column x * w, column y * w, depth
#if LAMINA_SPLIT
    uint material;
#endif
} laminaStage;

LaminaVertex laminaVertex();

void main() {
    LaminaVertex vertex = laminaVertex();
    dvec4 position = dvec4(dvec3(vertex.position), 1.0lf);
#if LAMINA_SPLIT
    laminaStage.material = vertex.material;
#endif
    laminaStage.column = dvec3(dot(laminaDraw.localToColumn[0], position),
                               dot(laminaDraw.localToColumn[1], position),
                               dot(laminaDraw.localToColumn[2], position));
}
