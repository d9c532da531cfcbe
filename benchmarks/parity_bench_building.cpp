#include "parity_bench.hpp"

#include "gl/device_state.hpp"

#include <lamina/parity/sprite_builder.hpp>

namespace lamina::bench {

void printBuilding(const Device& device, std::span<const Shape> meshes, int rounds) {
    const GladGLContext& gl = device.state()->gl;
    std::printf("\nBuilding, median of %d\n%-16s %9s %8s %7s | %-19s | %-19s | %s\n", rounds,
                "shape", "triangles", "columns", "layers", "single pass: wall, CPU",
                "peeling: wall, CPU", "peeling / single pass (CPU)");
    auto builder = need(SpriteBuilder::create(device));
    for (const Shape& shape : meshes)
        for (const std::uint32_t columns : {256u, 512u, 1024u}) {
            const auto transform = need(fitSprite(shape.mesh.bounds(), {0, 0, 1}, columns));
            auto buffers = need(MeshBuffers::upload(device, shape.mesh));
            const GeometrySource source = buffers.view();
            auto sprite = need(DepthSprite::create(device));
            need(builder.buildAndWait({&source, 1}, transform, sprite));
            const auto build = [&](SpriteMethod method) {
                return [&, method] {
                    need(builder.build({&source, 1}, transform, sprite.layers(), sprite, method));
                    gl.Finish();
                };
            };
            const auto times =
                measure<2>({build(SpriteMethod::SinglePass), build(SpriteMethod::Peeling)}, rounds);
            std::printf("%-16s %9zu %8u %7u | %9.1f %9.1f ms | %9.1f %9.1f ms | %.2f\n",
                        shape.name.c_str(), shape.mesh.triangles.size(), columns, sprite.layers(),
                        times[0].wall, times[0].processor, times[1].wall, times[1].processor,
                        times[1].processor / times[0].processor);
        }
}

} // namespace lamina::bench
