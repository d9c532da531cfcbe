#include "gl/support/grids.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace lamina::test {

GridTransform testGrid(std::uint32_t slices) {
    return GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {48, 40, slices}).value();
}

GridTransform shapesGrid(const glm::uvec3& size, Axis axis) {
    return GridTransform::box({{-1.01, -1.03, -1.02}, {1.04, 1.02, 1.03}}, size, axis).value();
}

GridTransform cameraGrid(Projection projection, const glm::uvec3& size,
                         const SliceDistribution& distribution) {
    const glm::dmat4 view = glm::lookAt(glm::dvec3(1.1, 1.7, 2.3), glm::dvec3(0.1, 0.0, -0.1),
                                        glm::dvec3(0.1, 1.0, 0.0));
    GridCamera camera = GridCamera::perspective(view, 0.9, double(size.x) / size.y, 1.2, 4.9);
    if (projection == Projection::Orthographic) {
        camera.projection = projection;
        camera.left = -1.4;
        camera.right = 1.5;
        camera.bottom = -1.3;
        camera.top = 1.4;
    }
    return GridTransform::camera(camera, size, distribution).value();
}

std::vector<GridTransform> makeCameraGrids(const glm::uvec3& size) {
    std::vector<float> boundaries(size.z + 1);
    for (std::size_t k = 0; k <= size.z; ++k)
        boundaries[k] = std::pow(static_cast<float>(k) / static_cast<float>(size.z), 1.7f);
    std::vector<GridTransform> grids;
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
        for (const SliceDistribution& distribution :
             {SliceDistribution::linear(), SliceDistribution::logarithmic(),
              SliceDistribution::custom(boundaries)})
            grids.push_back(cameraGrid(projection, size, distribution));
    return grids;
}

GridTransform eyeGrid(const glm::uvec3& size) {
    const glm::dmat4 view =
        glm::lookAt(glm::dvec3(0.05, 0.1, 0.2), glm::dvec3(0.7, 0.2, -0.4), glm::dvec3(0, 1, 0));
    return GridTransform::camera(
               GridCamera::perspective(view, 1.3, double(size.x) / size.y, 0.1, 3.0), size)
        .value();
}

} // namespace lamina::test
