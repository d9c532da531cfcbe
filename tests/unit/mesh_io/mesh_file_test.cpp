#include "mesh_samples.hpp"
#include "support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lamina {
namespace {

using namespace samples;
using testing::ElementsAre;
using testing::HasSubstr;

struct Corner {
    glm::vec3 position;
    bool operator==(const Corner&) const = default;
};

/// The corners of all triangles, so that meshes of different vertex order compare.
std::vector<Corner> cornersOf(const TriangleMesh& mesh) {
    std::vector<Corner> corners;
    for (const glm::uvec3& t : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back({mesh.positions.at(t[corner])});
    return corners;
}

void expectCube(const Result<TriangleMesh>& mesh) {
    ASSERT_TRUE(mesh) << mesh.error().text;
    ASSERT_TRUE(validate(*mesh));
    EXPECT_EQ(mesh->positions.size(), 8u);
    EXPECT_EQ(cornersOf(*mesh), cornersOf(cube()));
    // Angle weights: each normal of a cube points along its diagonal.
    ASSERT_EQ(mesh->normals.size(), mesh->positions.size());
    for (std::size_t i = 0; i < mesh->positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(mesh->normals[i][axis],
                        (mesh->positions[i][axis] - 0.5f) * 2 / std::sqrt(3.0f), 1e-6);
}

TEST(MeshFile, ReadsTheCubeInEveryFormat) {
    expectCube(parse(cubeObj(), MeshFormat::Obj));
    expectCube(parse(cubeOff(), MeshFormat::Off));
    expectCube(parse(cubeAsciiPly(), MeshFormat::Ply));
    expectCube(parse(cubeBinaryPly(std::endian::little), MeshFormat::Ply));
    expectCube(parse(cubeBinaryPly(std::endian::big), MeshFormat::Ply));
    expectCube(parse(cubeBinaryStl(), MeshFormat::Stl));
    expectCube(parse(cubeBinaryStl("solid but binary"), MeshFormat::Stl));
    expectCube(parse(cubeAsciiStl(), MeshFormat::Stl));
}

TEST(MeshFile, TellsFormatsByContent) {
    for (const std::string& content :
         {cubeObj(), cubeOff(), cubeAsciiPly(), cubeBinaryPly(std::endian::little),
          cubeBinaryPly(std::endian::big), cubeBinaryStl(), cubeBinaryStl("solid"), cubeAsciiStl()})
        expectCube(parse(content, MeshFormat::Automatic));
}

TEST(MeshFile, AcceptsEveryLineEndAndAByteOrderMark) {
    for (const char* end : {"\r\n", "\r"}) {
        expectCube(parse(replaced(cubeObj(), "\n", end), MeshFormat::Obj));
        expectCube(parse(replaced(cubeOff(), "\n", end), MeshFormat::Off));
        expectCube(parse(replaced(cubeAsciiPly(), "\n", end), MeshFormat::Ply));
        expectCube(parse(replaced(cubeAsciiStl(), "\n", end), MeshFormat::Stl));
    }
    const std::string mark = "\xEF\xBB\xBF";
    expectCube(parse(mark + cubeObj().substr(cubeObj().find("v 0")), MeshFormat::Obj));
    expectCube(parse(mark + cubeOff(), MeshFormat::Automatic));
    expectCube(parse(mark + cubeAsciiStl(), MeshFormat::Automatic));
}

TEST(MeshFile, AcceptsAMissingLastLineEnd) {
    for (std::string content : {cubeObj(), cubeOff(), cubeAsciiPly(), cubeAsciiStl()}) {
        content.pop_back();
        expectCube(parse(content, MeshFormat::Automatic));
    }
}

TEST(MeshFile, BinaryPlyBodyMayStartWithALineFeed) {
    // With CRLF and CR headers, a first body byte 0x0A belongs to the body.
    for (const char* end : {"\r\n", "\r", "\n"}) {
        std::string content = replaced("ply\nformat binary_little_endian 1.0\nelement tag 1\n"
                                       "property uchar t\nelement vertex 3\nproperty float x\n"
                                       "property float y\nproperty float z\nelement face 1\n"
                                       "property list uchar uchar vertex_index\nend_header\n",
                                       "\n", end);
        content += '\n';
        for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
            append(content, value);
        content += std::string("\x03\x00\x01\x02", 4);
        const auto mesh = parse(content, MeshFormat::Ply);
        ASSERT_TRUE(mesh) << mesh.error().text;
        EXPECT_EQ(mesh->positions[1], glm::vec3(1, 0, 0));
    }
}

TEST(MeshFile, ObjRelativeIndicesContinuationsCommentsAndForwardReferences) {
    const auto mesh = parse("v 0 0 0 # origin\nv 1 \\\n 0 0\nv 0 1 0\nf -3 -2 -1 # relative\n"
                            "f 1 2 4\nv 0 0 1\n\t f\t1   3\\\r\n 4\n",
                            MeshFormat::Obj);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->triangles,
                ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 1, 3), glm::uvec3(0, 2, 3)));
    EXPECT_EQ(mesh->positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(mesh->positions[3], glm::vec3(0, 0, 1));
}

TEST(MeshFile, ObjNormalsAreOfTheCornersAndSplitVertices) {
    const auto mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 0 -3 0\n"
                            "vt 0 0\nf 1/1/1 2//1 3//1\nf 1//2 4/1/2 2//2\n",
                            MeshFormat::Obj);
    ASSERT_TRUE(mesh) << mesh.error().text;
    ASSERT_EQ(mesh->positions.size(), 6u);
    ASSERT_EQ(mesh->normals.size(), 6u);
    for (int corner = 0; corner < 3; ++corner) {
        EXPECT_EQ(mesh->normals[mesh->triangles[0][corner]], glm::vec3(0, 0, 1));
        EXPECT_EQ(mesh->normals[mesh->triangles[1][corner]], glm::vec3(0, -1, 0));
    }
    EXPECT_EQ(cornersOf(*mesh),
              (std::vector<Corner>{
                  {{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 0}}, {{0, 0, 1}}, {{1, 0, 0}}}));
}

TEST(MeshFile, ObjNormalsOfSomeCornersOnlyAreReplaced) {
    const auto mesh =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3\n", MeshFormat::Obj);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->normals,
                ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 0, 1)));
}

TEST(MeshFile, UselessFileNormalsAreComputed) {
    const auto mesh =
        parse("NOFF\n3 1 0\n0 0 0 nan 0 0\n1 0 0 0 0 0\n0 1 0 0 5 0\n3 0 1 2\n", MeshFormat::Off);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->normals,
                ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)));
}

TEST(MeshFile, ObjColours) {
    const auto mesh = parse("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0 0 2 0.25\nv 5 5 5 1\nf 1 2 3\n",
                            MeshFormat::Obj);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->colors, ElementsAre(glm::vec4(1), glm::vec4(1, 0.5, 0, 1),
                                          glm::vec4(0, 0, 1, 0.25), glm::vec4(1)));
}

TEST(MeshFile, PlyAnyPropertyOrderTypesAndExtraElements) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        std::string content = "ply\nformat ";
        content += order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
        content +=
            " 1.0\nobj_info test\nelement camera 2\nproperty double fov\n"
            "element group 2\nproperty list ushort double data\nproperty char tag\n"
            "element nothing 18446744073709551615\n"
            "element face 2\nproperty uchar flag\nproperty list int ushort vertex_index\n"
            "property list uchar float texcoord\n"
            "element vertex 4\nproperty uchar red\nproperty short z\nproperty list uchar int l\n"
            "property double x\nproperty ushort green\nproperty int8 y\nproperty float blue\n"
            "property float nz\nproperty float nx\nproperty float ny\nproperty uint8 alpha\n"
            "end_header\n";
        append(content, 1.5, order);
        append(content, 2.5, order);
        for (const std::uint16_t count : {std::uint16_t{2}, std::uint16_t{0}}) {
            append(content, count, order);
            for (int i = 0; i < count; ++i)
                append(content, 7.0, order);
            append(content, std::int8_t{-1}, order);
        }
        for (const std::uint16_t last : {std::uint16_t{2}, std::uint16_t{3}}) {
            append(content, std::uint8_t{9}, order);
            append(content, std::int32_t{3}, order);
            for (const std::uint16_t index : {std::uint16_t{0}, std::uint16_t{1}, last})
                append(content, index, order);
            append(content, std::uint8_t{1}, order);
            append(content, 0.5f, order);
        }
        for (int i = 0; i < 4; ++i) {
            append(content, static_cast<std::uint8_t>(51 * i), order);
            append(content, static_cast<std::int16_t>(i == 3 ? -300 : 0), order);
            append(content, std::uint8_t{1}, order);
            append(content, std::int32_t{-7}, order);
            append(content, i == 1 ? 1e-3 : 0.0, order);
            append(content, std::uint16_t{65535}, order);
            append(content, static_cast<std::int8_t>(i == 2 ? -128 : 0), order);
            append(content, 0.25f, order);
            append(content, 0.0f, order);
            append(content, 4.0f, order);
            append(content, 0.0f, order);
            append(content, std::uint8_t{0}, order);
        }
        const auto mesh = parse(content, MeshFormat::Ply);
        ASSERT_TRUE(mesh) << mesh.error().text;
        EXPECT_THAT(mesh->positions, ElementsAre(glm::vec3(0), glm::vec3(1e-3f, 0, 0),
                                                 glm::vec3(0, -128, 0), glm::vec3(0, 0, -300)));
        EXPECT_THAT(mesh->triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 1, 3)));
        EXPECT_THAT(mesh->normals, testing::Each(glm::vec3(1, 0, 0)));
        EXPECT_EQ(mesh->colors[3], glm::vec4(0.6f, 1.0f, 0.25f, 0.0f));
    }
}

TEST(MeshFile, PlyTriangleStrips) {
    const auto mesh = parse("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                            "property float y\nproperty float z\nelement tristrips 1\n"
                            "property list int int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n8 0 1 2 3 -1 1 4 3\n",
                            MeshFormat::Ply);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->triangles,
                ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(2, 1, 3), glm::uvec3(1, 4, 3)));
}

TEST(MeshFile, OffPrefixesAndColours) {
    const auto bytes = parse("COFF\n3 1\n0 0 0 255 0 0 255\n1 0 0 0 255 0 0\n0 1 0 0 0 51\n"
                             "3 0 1 2 255 0 0\n",
                             MeshFormat::Off);
    ASSERT_TRUE(bytes) << bytes.error().text;
    EXPECT_THAT(bytes->colors, ElementsAre(glm::vec4(1, 0, 0, 1), glm::vec4(0, 1, 0, 0),
                                           glm::vec4(0, 0, 0.2f, 1)));
    const auto all = parse("STCNOFF 3 1 0\n0 0 0 0 0 1 1 0.5 0 1 0 0\n1 0 0 0 0 1 0 0 0 0.5 0 0\n"
                           "0 1 0 0 0 1 0 0 0 1 0 0\n3 0 1 2\n",
                           MeshFormat::Off);
    ASSERT_TRUE(all) << all.error().text;
    EXPECT_EQ(all->colors[0], glm::vec4(1, 0.5, 0, 1));
    EXPECT_EQ(all->colors[1], glm::vec4(0, 0, 0, 0.5));
}

TEST(MeshFile, StlWeldsIdenticalPositions) {
    const auto mesh =
        parse("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
              "vertex 0 1 0\nendloop\nendfacet\nendsolid\nSOLID two\nFacet Normal 0 0 0\n"
              "OUTER LOOP\nvertex -0 0 0\nvertex 1.0e0 0 0 vertex 0 0 +1\nendloop\n"
              "endfacet\nendsolid two\n",
              MeshFormat::Stl);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_THAT(mesh->triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 1, 3)));
}

TEST(MeshFile, UnusedNonFiniteVerticesKeepTheirPlace) {
    const auto mesh = parse("v 0 0 0\nv nan inf 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\n", MeshFormat::Obj);
    ASSERT_TRUE(mesh) << mesh.error().text;
    ASSERT_TRUE(validate(*mesh));
    EXPECT_EQ(mesh->positions[1], glm::vec3(0));
    EXPECT_EQ(mesh->triangles[0], glm::uvec3(0, 2, 3));
}

TEST(MeshFile, NormalsOnlyOnRequest) {
    MeshReadOptions options;
    options.computeNormals = false;
    const auto mesh = parse(cubeObj(), MeshFormat::Obj, options);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(mesh->normals.empty());
}

TEST(MeshFile, ProgressRisesAndCancels) {
    std::string content = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    while (content.size() < 4'500'000)
        content += "f 1 2 3 # a face with a comment to make the file longer\n";
    std::vector<float> shares;
    MeshReadOptions options;
    options.progress = [&](float share) {
        shares.push_back(share);
        return true;
    };
    ASSERT_TRUE(parse(content, MeshFormat::Obj, options));
    EXPECT_GE(shares.size(), 4u);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_LE(shares.back(), 1.0f);

    options.progress = [](float share) { return share < 0.4f; };
    const auto cancelled = parse(content, MeshFormat::Obj, options);
    ASSERT_FALSE(cancelled);
    EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
}

TEST(MeshFile, ReadsFromDiskByExtension) {
    const test::TemporaryFolder folder;
    const auto write = [&](const std::string& name, const std::string& content) {
        test::writeBytes(folder / name, content);
        return folder / name;
    };
    expectCube(readMesh(write("cube.obj", cubeObj())));
    expectCube(readMesh(write("CUBE.PLY", cubeBinaryPly(std::endian::big))));
    expectCube(readMesh(write("cube.Stl", cubeBinaryStl("solid"))));
    expectCube(readMesh(write("cube.off", cubeOff())));
    MeshReadOptions options;
    options.format = MeshFormat::Off;
    expectCube(readMesh(write("cube.dat", cubeOff()), options));

    const auto unknown = readMesh(folder / "cube.dat");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::UnknownFormat);
    EXPECT_THAT(unknown.error().text, HasSubstr(".obj, .ply, .stl or .off, found 'cube.dat'"));

    options = {};
    options.maxFileBytes = 100;
    const auto large = readMesh(folder / "cube.obj", options);
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, ErrorCode::OutOfMemory);
}

} // namespace
} // namespace lamina
