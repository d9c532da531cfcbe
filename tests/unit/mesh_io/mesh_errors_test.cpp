#include "mesh_samples.hpp"
#include "support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

namespace lamina {
namespace {

using namespace samples;
using testing::HasSubstr;

void expectError(const Result<TriangleMesh>& result, ErrorCode code, const std::string& text) {
    ASSERT_FALSE(result) << "expected: " << text;
    EXPECT_EQ(name(result.error().code), name(code)) << result.error().text;
    EXPECT_THAT(result.error().text, HasSubstr(text));
    EXPECT_THAT(result.error().text, HasSubstr(": expected "));
    EXPECT_THAT(result.error().text, HasSubstr("found "));
}

constexpr auto kFile = ErrorCode::InvalidFile;
constexpr auto kMesh = ErrorCode::InvalidMesh;

TEST(MeshErrors, Obj) {
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& text) {
        expectError(parse(content, MeshFormat::Obj), code, text);
    };
    expect("", kFile, "an empty file");
    expect("# nothing\n", kMesh, "at least one triangle, found 0 vertices and no face");
    expect(v, kMesh, "at least one triangle, found 3 vertices and no face");
    expect("f /1 2 3", kFile,
           "line 1: expected a face corner like 1, 1/1, 1//1 or 1/1/1, found ''");
    expect(v + "f 1 2\n", kFile, "line 4: expected a face of at least 3 corners, found 2");
    expect(v + "f 1 2 4\n", kMesh, "line 4: expected vertex indices up to 3, found 4");
    expect(v + "f 1 2 0\n", kMesh, "line 4: expected an index from 1 to 2^32 - 1, found '0'");
    expect(v + "f 1 2 -4\n", kMesh, "line 4: expected a relative index down to -3, found '-4'");
    expect(v + "f 1 2 99999999999\n", kMesh, "an index from 1 to 2^32 - 1, found '99999999999'");
    expect(v + "f 1 2 99999999999999999999\n", kFile, "a face corner like");
    expect(v + "f 1 2 3x\n", kFile, "found '3x'");
    expect(v + "f 1/ 2/ 3/\n", kFile, "found ''");
    expect(v + "f 1/1 2/1 3/1\n", kMesh,
           "line 4: expected texture coordinate indices only where the file has such vertices, "
           "found 1");
    expect(v + "vn 0 0 1\nf 1//1 2//7 3//1\n", kMesh,
           "line 5: expected normal indices up to 1, found 7");
    expect("v 0 0\n", kFile, "line 1: expected 3 coordinates");
    expect("v 0 0 0 1 1\n", kFile, "found 5 numbers");
    expect("v 1 2 3 4 5 6 7 8\n", kFile, "found '8' after 7 numbers");
    expect("\r\n\r\nv 0 zero 0\n", kFile, "line 3: expected 3 coordinates, found 'zero'");
    expect("vn 0 1\n", kFile, "line 1: expected a normal of 3 numbers, found 2");
    expect("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", kMesh,
           "line 2: expected finite vertex coordinates, found a non-finite vertex (nan,");
    expect("v 0 0 0\nv 0 -inf 0\nv 0 1 0\nf 1 2 3\n", kMesh, "line 2: ");
    expect("v 0 0 0\nv 0 1e99 0\nv 0 1 0\nf 1 2 3\n", kMesh, "line 2: ");
    expect(std::string("\x7f"
                       "ELF\x02\x01\x00\x00garbage",
                       15),
           kFile, "line 1: expected an OBJ statement (v, vn, vt, f, ...), found '?ELF????garbage'");
}

TEST(MeshErrors, PlyHeader) {
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& text) {
        expectError(parse(content, MeshFormat::Ply), code, text);
    };
    const std::string cube = cubeAsciiPly();
    expect("", kFile, "an empty file");
    expect("plx\n", kFile, "line 1: expected 'ply', found 'plx?'");
    expect("ply", kFile, "line 1: expected 'ply'");
    expect("ply\nformat ascii 1.0\n", kFile, "line 3: expected 'end_header'");
    expect(replaced(cube, "end_header\n", ""), kFile, "expected a PLY header statement, found '0'");
    expect(replaced(cube, "ascii 1.0", "ascii 2.0"), ErrorCode::Unsupported,
           "line 2: expected PLY version 1.0, found '2.0'");
    expect(replaced(cube, "ascii", "utf8"), kFile, "line 2: expected format ascii,");
    expect(replaced(cube, "format ascii 1.0\n", ""), kFile,
           "a 'format' line in the header, found none");
    expect(replaced(cube, "element vertex 8", "element vertex -8"), kFile,
           "line 4: expected an element's name and its count, found 'element vertex -8'");
    expect(replaced(cube, "element vertex 8", "element vertex"), kFile, "line 4: ");
    expect(replaced(cube, "element face 6", "element vertex 8"), kFile, "each element once");
    expect(replaced(cube, "float x", "floaty x"), kFile,
           "line 5: expected a property type (float, uchar, ...), found 'floaty'");
    expect(replaced(cube, "float x", "float w"), kFile, "vertex properties x, y and z");
    expect(replaced(cube, "float y", "float x"), kFile, "each vertex property once");
    expect(replaced(cube, "list uchar", "list float"), kFile,
           "an integer type for the list's count, found 'float'");
    expect(replaced(cube, "vertex_indices", "corners"), kFile,
           "a list property vertex_indices of face, found none");
}

TEST(MeshErrors, PlyCounts) {
    const std::string text = cubeAsciiPly();
    const std::string binary = cubeBinaryPly(std::endian::little);
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& message) {
        expectError(parse(content, MeshFormat::Ply), code, message);
    };
    for (const std::string& cube : {text, binary}) {
        expect(replaced(cube, "vertex 8", "vertex 99999999999"), kFile,
               "expected room for 99999999999 vertex elements of at least");
        expect(replaced(cube, "vertex 8", "vertex 18446744073709551615"), kFile,
               "expected room for");
        expect(replaced(cube, "face 6", "face 4000000000"), kFile,
               "expected room for 4000000000 face elements of at least");
        expect(replaced(cube, "face 6", "face 5"), kFile,
               "the end of the file after the last element");
        expect(replaced(cube, "face 6", "face 0"), kFile,
               "the end of the file after the last element");
    }
    expect(replaced(text, "vertex 8", "vertex 9"), kFile, "line 19: expected the end of the line");
    expect(replaced(text, "face 6", "face 7"), kFile,
           "line 24: expected 7 face rows, found the end of the file after 6");
    expect(text.substr(0, text.size() - 3), kFile,
           "line 24: expected a list count up to 3 (there is no room for more), found 4");
    expect(text.substr(0, text.size() - 10), kFile,
           "line 23: expected 6 face rows, found the end of the file after 5");
    expect(binary.substr(0, binary.size() - 1), kFile,
           "byte " + std::to_string(binary.size() - 17) + ": expected a list count up to 3");
    expect(replaced(text, "4 1 3 7 5", "4 1 3   7"), kFile,
           "line 24: expected a number, found the end of the line");
    expect(replaced(binary, "face 6", "face 7"), kFile,
           "byte " + std::to_string(binary.size()) +
               ": expected 1 more bytes, found the end of the file after 0");

    std::string list = binary;
    list[binary.size() - 17] = '\xFF';
    expect(list, kFile, "a list count up to 4 (there is no room for more), found 255");
    list = replaced(binary, "list uchar", "list char");
    list[list.size() - 17] = '\xFF';
    expect(list, kFile, "found -1");
    expect(replaced(text, "4 1 3 7 5", "2000000000 1 3 7 5"), kFile, "line 24: ");
    expect(replaced(text, "4 1 3 7 5", "1e300 1 3 7 5"), kFile, "line 24: expected a list count");
    expect(replaced(text, "4 1 3 7 5", "nan 1 3 7 5"), kFile, "line 24: expected a list count");
    expect(replaced(text, "4 1 3 7 5", "2 1 3"), kFile,
           "line 24: expected a face of at least 3 corners, found 2");
    expect(replaced(text, "4 1 3 7 5", "4 1 3 7 5 9"), kFile,
           "line 24: expected the end of the line, found '9' more");
}

TEST(MeshErrors, PlyValues) {
    const std::string text = cubeAsciiPly();
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& message) {
        expectError(parse(content, MeshFormat::Ply), code, message);
    };
    expect(replaced(text, "4 1 3 7 5", "4 1 3 7 8"), kMesh,
           "line 24: expected vertex indices up to 7, found 8");
    expect(replaced(text, "4 1 3 7 5", "4 1 3 7 -1"), kMesh,
           "line 24: expected vertex indices that are whole numbers from 0, found -1");
    expect(replaced(text, "4 1 3 7 5", "4 1 3 7 1.5"), kMesh, "found 1.5");
    expect(replaced(text, "4 1 3 7 5", "4 1 3 7 1e30"), kMesh, "found 1e+30");
    expect(replaced(text, "1 1 1", "1 nan 1"), kMesh,
           "line 18: expected finite vertex coordinates, found a non-finite vertex (1.000000, nan");
    expect(replaced(text, "1 1 1", "1 ? 1"), kFile, "line 18: expected a number, found '?'");

    std::string binary = cubeBinaryPly(std::endian::little);
    const std::size_t body = binary.find("end_header\n") + 11;
    const float infinity = std::numeric_limits<float>::infinity();
    std::memcpy(binary.data() + body + 12 * 5 + 4, &infinity, 4);
    expect(binary, kMesh,
           "byte " + std::to_string(body + 60) + ": expected finite vertex coordinates");
    binary = cubeBinaryPly(std::endian::little);
    binary[binary.size() - 2] = 1;
    expect(binary, kMesh, "vertex indices up to 7, found 65541");
}

TEST(MeshErrors, Stl) {
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& text) {
        expectError(parse(content, MeshFormat::Stl), code, text);
    };
    const std::string text = cubeAsciiStl();
    const std::string binary = cubeBinaryStl();
    expect("", kFile, "an empty file");
    expect("junk", kFile,
           "byte 4: expected an 84-byte binary STL header or a text that starts with");
    expect(binary.substr(0, binary.size() - 1), kFile,
           "byte 80: expected a file of 684 bytes for 12 triangles, found 683 bytes");
    expect(cubeBinaryStl("solid").substr(0, 600), kFile, "byte 80: expected a file of 684 bytes");
    std::string huge = binary;
    huge.replace(80, 4, "\xFF\xFF\xFF\xFF");
    expect(huge, kFile, "byte 80: expected a file of 214748364834 bytes for 4294967295 triangles");
    std::string nan = binary;
    nan.replace(84 + 50 + 12, 4, "\xFF\xFF\xFF\xFF");
    expect(nan, kMesh,
           "byte 146: expected finite vertex coordinates, found a non-finite vertex in "
           "triangle 1");
    expect("solid empty\nendsolid\n", kMesh, "at least one triangle, found 0 vertices");
    expect(text.substr(0, text.find("endsolid")), kFile, "'facet' or 'endsolid', found the end of");
    expect(text.substr(0, text.find("vertex")), kFile,
           "line 4: expected 'vertex', found the end of the file");
    expect(replaced(text, "vertex 1 1 1", "vertex 1 x 1"), kFile, "expected a number, found 'x'");
    expect(replaced(text, "vertex 1 1 1", "vertex 1 inf 1"), kMesh,
           "expected finite vertex coordinates, found a non-finite vertex");
    expect("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", kFile,
           "line 6: expected 'vertex', found 'endloop'");
    expect(text + "trailing", kFile, "line 87: expected 'solid', found 'trailing'");
}

TEST(MeshErrors, Off) {
    const auto expect = [](const std::string& content, ErrorCode code, const std::string& text) {
        expectError(parse(content, MeshFormat::Off), code, text);
    };
    const std::string cube = cubeOff();
    expect("", kFile, "an empty file");
    expect("OFF", kFile, "line 1: expected counts of vertices, faces and edges, found ''");
    expect("FOO\n", kFile, "line 1: expected the keyword OFF, found 'FOO'");
    expect("4OFF\n", ErrorCode::Unsupported, "3-dimensional vertices, found '4OFF'");
    expect("OFF BINARY\n", ErrorCode::Unsupported, "a text OFF file, found BINARY");
    expect(replaced(cube, "8 6 12", "-8 6 12"), kFile, "line 3: expected counts of vertices");
    expect(replaced(cube, "8 6 12", "8000000000 6 12"), kFile,
           "line 3: expected room for 8000000000 vertices and 6 faces");
    expect(replaced(cube, "8 6 12", "18446744073709551615 18446744073709551615 0"), kFile,
           "expected room for");
    expect(replaced(cube, "8 6 12", "8 7 12"), kFile,
           "expected 7 faces, found the end of the file after 6");
    expect(replaced(cube, "8 6 12", "8 5 12"), kFile,
           "line 17: expected the end of the file after 5 faces, found '4 1 3 7 5'");
    expect(replaced(cube, "8 6 12", "9 6 12"), kFile,
           "line 12: expected 3 numbers a vertex, found 5");
    expect(replaced(cube, "4 1 3 7 5", "2000000000 1 3 7 5"), kFile,
           "line 17: expected 2000000000 vertex indices, found 4");
    expect(replaced(cube, "4 1 3 7 5", "4 1 3 7 8"), kMesh,
           "line 17: expected vertex indices from 0 to below 8, found 8");
    expect(replaced(cube, "4 1 3 7 5", "4 1 3 7 -1"), kMesh, "found -1");
    expect(replaced(cube, "4 1 3 7 5", "2 1 3"), kFile, "a face of at least 3 corners, found '2'");
    expect(replaced(cube, "1 1 1", "1 1 nan"), kMesh,
           "line 11: expected finite vertex coordinates, found a non-finite vertex");
    expect(replaced(cube, "1 1 1", "1 1"), kFile, "line 11: expected 3 numbers a vertex, found 2");
}

class MeshFileErrors : public testing::Test {
protected:
    const test::TemporaryFolder mFolder;
};

TEST_F(MeshFileErrors, NameTheFile) {
    const std::filesystem::path file = mFolder / "broken.obj";
    std::ofstream(file) << "v 0 0\n";
    expectError(readMesh(file), kFile, "read mesh " + file.string() + ": line 1: expected");
}

TEST_F(MeshFileErrors, MissingEmptyAndOddFiles) {
    expectError(readMesh(mFolder / "none.ply"), ErrorCode::NotFound,
                "none.ply: expected a file, found none");
    expectError(readMesh(mFolder / "none.xyz"), ErrorCode::NotFound, "expected a file, found none");
    expectError(readMesh(""), ErrorCode::NotFound, "expected a file, found none");

    std::ofstream(mFolder / "empty.stl").flush();
    expectError(readMesh(mFolder / "empty.stl"), kFile, "expected a mesh, found an empty file");

    std::filesystem::create_directory(mFolder / "folder.obj");
    expectError(readMesh(mFolder / "folder.obj"), ErrorCode::InputOutput,
                "expected a regular file, found a directory");

    ASSERT_EQ(::mkfifo((mFolder / "pipe.obj").c_str(), 0600), 0);
    expectError(readMesh(mFolder / "pipe.obj"), ErrorCode::InputOutput, "found a pipe");

    std::filesystem::create_symlink("/dev/zero", mFolder / "zero.ply");
    expectError(readMesh(mFolder / "zero.ply"), ErrorCode::InputOutput, "found a device");
}

TEST_F(MeshFileErrors, UnreadableFiles) {
    // A loop of links cannot be opened by anyone, root included.
    std::filesystem::create_symlink("loop.obj", mFolder / "loop.obj");
    expectError(readMesh(mFolder / "loop.obj"), ErrorCode::InputOutput,
                "expected a readable file, found '");

    const std::filesystem::path locked = mFolder / "locked.obj";
    std::ofstream(locked) << cubeObj();
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    if (::geteuid() != 0) // root reads everything
        expectError(readMesh(locked), ErrorCode::InputOutput, "expected a readable file, found '");
}

} // namespace
} // namespace lamina
