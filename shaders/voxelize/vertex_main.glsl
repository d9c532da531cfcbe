// main() of the vertex stage of every raster backend: runs the source's laminaVertex() and moves its
// position to column space in double precision, so that voxel coordinates carry no float rounding.
#include <lamina/vertex_interface.glsl>
#include <voxelize/draw_block.glsl>

out LaminaVertexStage {
    dvec3 column; // column x * w, column y * w, depth
} laminaStage;

LaminaVertex laminaVertex();

void main() {
    dvec4 position = dvec4(dvec3(laminaVertex().position), 1.0lf);
    laminaStage.column = dvec3(dot(laminaDraw.localToColumn[0], position),
                               dot(laminaDraw.localToColumn[1], position),
                               dot(laminaDraw.localToColumn[2], position));
}
