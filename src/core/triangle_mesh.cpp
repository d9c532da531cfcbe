#include <lamina/core/triangle_mesh.hpp>

#include <cmath>
#include <string>

namespace lamina {

Box3 TriangleMesh::bounds() const {
    Box3 box;
    for (const glm::uvec3& triangle : triangles)
        for (int corner = 0; corner < 3; ++corner)
            box.extend(glm::dvec3(positions[triangle[corner]]));
    return box;
}

Result<void> validate(const TriangleMesh& mesh) {
    const auto invalid = [](std::string text) {
        return Error{ErrorCode::InvalidMesh, "mesh: " + std::move(text)};
    };
    const std::size_t vertexCount = mesh.positions.size();
    if (mesh.triangles.empty())
        return invalid("expected at least one triangle, found none");
    if (!mesh.normals.empty() && mesh.normals.size() != vertexCount)
        return invalid("expected one normal a vertex (" + std::to_string(vertexCount) +
                       "), found " + std::to_string(mesh.normals.size()));
    if (!mesh.colors.empty() && mesh.colors.size() != vertexCount)
        return invalid("expected one colour a vertex (" + std::to_string(vertexCount) +
                       "), found " + std::to_string(mesh.colors.size()));
    for (std::size_t i = 0; i < vertexCount; ++i) {
        const glm::vec3& p = mesh.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return invalid("expected finite positions, found vertex " + std::to_string(i) +
                           " at (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " +
                           std::to_string(p.z) + "); remove or repair it");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int corner = 0; corner < 3; ++corner)
            if (mesh.triangles[i][corner] >= vertexCount)
                return invalid("expected vertex indices below " + std::to_string(vertexCount) +
                               ", found " + std::to_string(mesh.triangles[i][corner]) +
                               " in triangle " + std::to_string(i));
    return {};
}

} // namespace lamina
