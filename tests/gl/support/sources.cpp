#include "gl/support/sources.hpp"

#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <cstdint>
#include <cstring>
#include <limits>

namespace lamina::test {

TriangleMesh makeKnot() {
    return reference::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12);
}

std::vector<glm::vec3> degenerateTriangles() {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {
        {kNan, 0, 0}, {1, 0, 0},         {0, 1, 0},    // NaN
        {0, 0, 0},    {kInfinity, 0, 0}, {0, 1, 0},    // infinite
        {0, 0, 0},    {0.5f, 0.5f, 0},   {1, 1, 0},    // collinear
        {0, 0, 0},    {0, 0, 0},         {0, 0, 0},    // a point
        {0, 0, -1},   {0, 1, -1},        {0, 0.5f, 1}, // edge-on
    };
}

std::vector<PlacedMesh> placedMeshes() {
    const glm::mat4 one(1.0f);
    return {
        {reference::makeIcosphere({0.3f, 0, 0}, 0.4f, 2), one},
        {makeKnot(), glm::translate(one, {0.25f, -0.5f, 0.125f})},
        {reference::makeCube({0, 0.2f, 0}, 0.8f),
         glm::rotate(glm::scale(one, {0.5f, -1.5f, 1.0f}), 0.7f, glm::vec3(1, 2, 3))},
    };
}

void forEachLayout(const TriangleMesh& mesh,
                   const std::function<GLuint(std::span<const std::byte>)>& upload,
                   const std::function<void(const MeshView&, const std::string&)>& check) {
    std::vector<std::uint16_t> shortIndices(7); // begins at an offset
    std::vector<glm::vec3> soup;
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            shortIndices.push_back(static_cast<std::uint16_t>(triangle[corner]));
            soup.push_back(mesh.positions[triangle[corner]]);
        }
    shortIndices.resize(shortIndices.size() | 1u); // its last word is half a word
    const GLuint longBuffer = upload(std::as_bytes(std::span(mesh.triangles)));
    const GLuint oddBuffer = upload(std::as_bytes(std::span(shortIndices)));
    shortIndices.push_back(0);
    const GLuint evenBuffer = upload(std::as_bytes(std::span(shortIndices)));

    for (const std::uint32_t stride : {12u, 16u, 32u, 100u, 2048u})
        for (const std::size_t offset : {0u, 4u, 1028u}) {
            const auto interleave = [&](std::span<const glm::vec3> positions) {
                std::vector<std::byte> bytes(offset + positions.size() * stride, std::byte{0x7f});
                for (std::size_t i = 0; i < positions.size(); ++i)
                    std::memcpy(bytes.data() + offset + i * stride, &positions[i], 12);
                return upload(bytes);
            };
            const std::string place =
                "stride " + std::to_string(stride) + ", offset " + std::to_string(offset);
            MeshView view;
            view.vertexBuffer = interleave(mesh.positions);
            view.vertexStrideBytes = stride;
            view.positionOffsetBytes = offset;
            view.vertexCount = static_cast<std::uint32_t>(mesh.positions.size());
            view.indexBuffer = longBuffer;
            view.indexType = IndexType::UInt32;
            view.indexCount = static_cast<std::uint32_t>(soup.size());
            check(view, place + ", 32-bit indices");
            view.indexType = IndexType::UInt16;
            view.indexOffsetBytes = 14;
            view.indexBuffer = oddBuffer;
            check(view, place + ", an odd number of 16-bit indices");
            view.indexBuffer = evenBuffer;
            check(view, place + ", an even number of 16-bit indices");
            view = {};
            view.vertexBuffer = interleave(soup);
            view.vertexStrideBytes = stride;
            view.positionOffsetBytes = offset;
            view.vertexCount = static_cast<std::uint32_t>(soup.size());
            check(view, place + ", no indices");
        }
}

} // namespace lamina::test
