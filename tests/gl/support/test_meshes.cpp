#include "gl/support/test_meshes.hpp"

#include <lamina/mesh_io/mesh_file.hpp>

#include <reference/shapes.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace lamina::test {

namespace ref = reference;

std::vector<NamedMesh> makeShapes() {
    const Box3 box{{-1, -1, -1}, {1, 1, 1}};
    const float radii[] = {1.0f, 0.8f, 0.5f};
    return {
        {"box", ref::makeBox({-0.9f, -0.8f, -0.7f}, {0.6f, 0.7f, 0.8f})},
        {"tetrahedron", ref::makeTetrahedron({-0.9f, -0.7f, -0.8f}, {0.9f, -0.6f, -0.5f},
                                             {0.1f, 0.9f, -0.4f}, {0.0f, 0.1f, 0.9f})},
        {"icosphere", ref::makeIcosphere({0, 0, 0}, 0.95f, 4)},
        {"torus knot", ref::makeTorusKnot({0, 0, 0}, 0.55f, 0.12f, 2, 3, 256, 24)},
        {"menger sponge", ref::makeMengerSponge({0, 0, 0}, 1.8f, 2)},
        {"nested shells", ref::makeNestedShells({0, 0, 0}, radii, 3)},
        {"slivers", ref::makeSlivers(box, 3000, 0.8f, 0.002f, 1)},
        {"triangle soup", ref::makeTriangleSoup(box, 4000, 0.3f, 2)},
        {"sloped plane", ref::makePlane({0, 0, 0}, {0.3f, 0.2f, 1.0f}, 1.6f, 7)},
        {"steep plane", ref::makePlane({0, 0, 0}, {1.0f, 0.3f, 0.001f}, 1.2f, 3)},
    };
}

std::vector<NamedMesh> readRealMeshes(const std::vector<std::string>& files) {
    std::vector<std::filesystem::path> paths = {"/usr/share/glmark2/models/bunny.obj"};
    if (const char* directory = std::getenv("LAMINA_MESH_DIR"))
        for (const std::string& file : files)
            paths.push_back(std::filesystem::path(directory) / file);
    std::vector<NamedMesh> meshes;
    for (const auto& path : paths) {
        if (!std::filesystem::exists(path))
            continue;
        auto mesh = readMesh(path);
        EXPECT_TRUE(mesh) << mesh.error().text;
        if (mesh)
            meshes.push_back({path.filename().string(), std::move(*mesh)});
    }
    return meshes;
}

} // namespace lamina::test
