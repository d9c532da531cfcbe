#include "grid_fixture.hpp"

#include <lamina/grid_io/grid_file.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using namespace std::string_literals;

const glm::uvec3 kCounts(40, 33, 130);

std::string npyFile(const std::string& dictionary, const std::string& data) {
    std::string header =
        dictionary + std::string((64 - (10 + dictionary.size() + 1) % 64) % 64, ' ') + "\n";
    return "\x93NUMPY\x01\x00"s + static_cast<char>(header.size() & 0xff) +
           static_cast<char>(header.size() >> 8) + header + data;
}

std::string npyHeader(const std::string& descr, const std::string& order,
                      const std::string& shape) {
    return "{'descr': '" + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
}

std::string binvoxFile(const std::string& dims, const std::string& data) {
    return "#binvox 1\ndim " + dims + "\ntranslate -1 -2 -3\nscale 4\ndata\n" + data;
}

class GridRead : public testing::Test {
protected:
    Error errorOf(const std::string& name, const std::string& content) {
        test::writeBytes(mFolder / name, content);
        const auto grid = readGrid(mFolder / name);
        if (grid) {
            ADD_FAILURE() << "read without error";
            return {};
        }
        return grid.error();
    }
    TemporaryFolder mFolder;
};

TEST_F(GridRead, ReadsWhatWasWrittenFromAnyAxis) {
    for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
        for (const char* name : {"grid.npy", "grid.binvox"}) {
            const BitGrid grid =
                test::randomGrid(test::boxOf(kCounts, {0.25, 0.25, 0.25}), kCounts, axis);
            ASSERT_TRUE(writeGrid(mFolder / name, grid));
            const auto read = readGrid(mFolder / name);
            ASSERT_TRUE(read) << read.error().text;
            EXPECT_EQ(read->transform().boxAxis(), Axis::Z);
            EXPECT_EQ(test::occupancy(*read, kCounts), test::occupancy(grid, kCounts));
        }
}

TEST_F(GridRead, BinvoxKeepsThePlaceInTheWorld) {
    const BitGrid grid = test::randomGrid(test::boxOf(kCounts, {0.1, 0.1, 0.1}), kCounts, Axis::X);
    ASSERT_TRUE(writeGrid(mFolder / "grid.binvox", grid));
    const auto read = readGrid(mFolder / "grid.binvox");
    ASSERT_TRUE(read) << read.error().text;
    const Box3& expected = grid.transform().boxBounds();
    const Box3& found = read->transform().boxBounds();
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(found.min[i], expected.min[i]);
        EXPECT_NEAR(found.max[i], expected.max[i], 1e-12);
    }
}

TEST_F(GridRead, BinvoxByHand) {
    // dim X Z Y: 2 along x, 3 along z, 4 along y; y runs fastest. Set: the last 5 of 24.
    test::writeBytes(mFolder / "hand.binvox", binvoxFile("2 3 4", "\x00\x13\x01\x05"s));
    const auto grid = readGrid(mFolder / "hand.binvox");
    ASSERT_TRUE(grid) << grid.error().text;
    EXPECT_EQ(grid->size(), glm::uvec3(2, 4, 3));
    EXPECT_EQ(grid->transform().boxBounds().min, glm::dvec3(-1, -2, -3));
    EXPECT_EQ(grid->transform().boxBounds().max,
              glm::dvec3(1, 2, 0)); // Edge: scale 4 over 4 voxels.
    EXPECT_EQ(grid->count(), 5u);
    for (const glm::uvec3 voxel : {glm::uvec3(1, 3, 1), {1, 0, 2}, {1, 1, 2}, {1, 2, 2}, {1, 3, 2}})
        EXPECT_TRUE(grid->test(voxel)) << voxel.x << voxel.y << voxel.z;
}

TEST_F(GridRead, NpyByHand) {
    // Shape (NZ, NY, NX) = (2, 1, 3).
    test::writeBytes(mFolder / "hand.npy",
                     npyFile(npyHeader("|b1", "False", "(2, 1, 3)"), "\x00\x01\x00\x00\x00\x01"s));
    const auto grid = readGrid(mFolder / "hand.npy");
    ASSERT_TRUE(grid) << grid.error().text;
    EXPECT_EQ(grid->size(), glm::uvec3(3, 1, 2));
    EXPECT_EQ(grid->transform().boxBounds().max, glm::dvec3(3, 1, 2));
    EXPECT_EQ(grid->count(), 2u);
    EXPECT_TRUE(grid->test({1, 0, 0}));
    EXPECT_TRUE(grid->test({2, 0, 1}));
}

TEST_F(GridRead, NpyHeaderErrors) {
    const std::string six(6, '\0');
    struct Case {
        std::string content;
        ErrorCode code;
        const char* text;
    };
    const Case cases[] = {
        {"", ErrorCode::InvalidFile, "found a file of 0 bytes"},
        {"not an array at all", ErrorCode::InvalidFile, "expected '\\x93NUMPY' at byte 0"},
        {"\x93NUMPY\x07\x00\x10\x00"s + six, ErrorCode::InvalidFile,
         "version 1, 2 or 3 at byte 6, found 7"},
        {"\x93NUMPY\x01\x00\xff\xff{}"s, ErrorCode::InvalidFile, "header of 65535 bytes"},
        {"\x93NUMPY\x02\x00\xff\xff\xff\xff"s, ErrorCode::InvalidFile,
         "expected a header of 4294967295 bytes"},
        {npyFile("{'descr': '|u1'}", six), ErrorCode::InvalidFile, "expected a dictionary"},
        {npyFile("{'descr': '|u1', 'shape': (1, ", six), ErrorCode::InvalidFile,
         "expected a dictionary"},
        {npyFile(npyHeader("|u1", "False", "(1, -2, 3)"), six), ErrorCode::InvalidFile,
         "expected a dictionary"},
        {npyFile(npyHeader("<f4", "False", "(2, 1, 3)"), six), ErrorCode::Unsupported,
         "found '<f4'"},
        {npyFile(npyHeader("|u1", "True", "(2, 1, 3)"), six), ErrorCode::Unsupported,
         "Fortran order"},
        {npyFile(npyHeader("|u1", "False", "(6,)"), six), ErrorCode::Unsupported,
         "(NZ, NY, NX), found (6)"},
        {npyFile(npyHeader("|u1", "False", "(2, 0, 3)"), six), ErrorCode::InvalidFile,
         "at least one voxel"},
        {npyFile(npyHeader("|u1", "False", "(2, 1, 4)"), six), ErrorCode::InvalidFile,
         "found 6 bytes of data"},
        {npyFile(npyHeader("|u1", "False", "(1, 1, 3)"), six), ErrorCode::InvalidFile,
         "found 6 bytes of data"},
        {npyFile(npyHeader("|u1", "False", "(18446744073709551615, 18446744073709551615, 6)"), six),
         ErrorCode::InvalidFile, "found 6 bytes of data"},
        {npyFile(npyHeader("|u1", "False", "(4294967296, 4294967296, 4294967296)"), six),
         ErrorCode::InvalidFile, "found 6 bytes of data"},
    };
    for (const Case& c : cases) {
        const Error error = errorOf("bad.npy", c.content);
        EXPECT_EQ(error.code, c.code) << error.text;
        EXPECT_THAT(error.text, HasSubstr(c.text));
    }
}

TEST_F(GridRead, BinvoxErrors) {
    struct Case {
        std::string content;
        const char* text;
    };
    const Case cases[] = {
        {"", "line 1: expected '#binvox 1'"},
        {"#binvox 2\n", "line 1: expected '#binvox 1'"},
        {std::string(100000, 'x'), "line 1: expected '#binvox 1'"},
        {"#binvox 1\ndim 2 2\n", "line 2: expected 'dim' and three counts"},
        {"#binvox 1\ndim 2 -2 2\n", "line 2: expected 'dim' and three counts"},
        {"#binvox 1\ndim 2 2 0\n", "line 2: expected 'dim' and three counts"},
        {"#binvox 1\ndim 2 2 99999999999\n", "line 2: expected 'dim' and three counts"},
        {"#binvox 1\ndim 2 2 2\ntranslate 0 nan 0\n",
         "line 3: expected 'translate' and three finite numbers"},
        {"#binvox 1\ndim 2 2 2\nscale 0\n", "line 3: expected 'scale' and a positive number"},
        {"#binvox 1\ndim 2 2 2\nwhat\n", "line 3: expected dim, translate, scale or data"},
        {"#binvox 1\ndata\n", "line 2: expected 'dim' before 'data'"},
        {"#binvox 1\ndim 2 2 2\n", "after line 2: expected the line 'data'"},
        {binvoxFile("2 2 2", "\x00\x07"s),
         "expected runs for the voxels of 2 x 2 x 2, found runs for 7 voxels"},
        {binvoxFile("2 2 2", "\x00\x09"s), "found runs for 9 voxels"},
        {binvoxFile("2 2 2", "\x00\x08\x01"s), "found one alone at the end"},
        {binvoxFile("2 2 2", "\x02\x08"s), "found 2 and 8"},
        {binvoxFile("2 2 2", "\x01\x00"s), "found 1 and 0"},
        {binvoxFile("4294967295 4294967295 4294967295", "\x01\xff"s), "found runs for 255 voxels"},
    };
    for (const Case& c : cases) {
        const Error error = errorOf("bad.binvox", c.content);
        EXPECT_EQ(error.code, ErrorCode::InvalidFile) << error.text;
        EXPECT_THAT(error.text, HasSubstr(c.text));
    }
}

TEST_F(GridRead, BinvoxOfManyColumnsIsBoundedByTheFile) {
    // 67 million columns of one voxel: 256 KiB of runs that would need a gigabyte.
    std::string runs;
    for (std::uint64_t left = 8192 * 8192; left > 0;) {
        const std::uint64_t length = std::min<std::uint64_t>(left, 255);
        runs += {'\x00', static_cast<char>(length)};
        left -= length;
    }
    const Error error = errorOf("flat.binvox", binvoxFile("8192 8192 1", runs));
    EXPECT_EQ(error.code, ErrorCode::OutOfMemory) << error.text;
    EXPECT_THAT(error.text, HasSubstr("8192 x 1 x 8192"));
}

TEST_F(GridRead, NamesMissingAndUnreadableFiles) {
    EXPECT_EQ(readGrid(mFolder / "none.npy").error().code, ErrorCode::NotFound);
    std::filesystem::create_directory(mFolder / "dir.npy");
    const auto directory = readGrid(mFolder / "dir.npy");
    EXPECT_EQ(directory.error().code, ErrorCode::InputOutput);
    EXPECT_THAT(directory.error().text, HasSubstr("found a directory"));
    const auto written = readGrid(mFolder / "a.vox");
    EXPECT_EQ(written.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(written.error().text, HasSubstr("only written"));
    EXPECT_EQ(readGrid(mFolder / "a.xyz").error().code, ErrorCode::UnknownFormat);
}

TEST_F(GridRead, MutatedFilesGiveAGridOrAnError) {
    const glm::uvec3 counts(9, 7, 11);
    const BitGrid grid = test::randomGrid(test::boxOf(counts, {1, 1, 1}), counts, Axis::Z);
    for (const char* name : {"grid.npy", "grid.binvox"}) {
        ASSERT_TRUE(writeGrid(mFolder / name, grid));
        const std::string original = test::readBytes(mFolder / name);
        std::mt19937 random(5);
        int errors = 0;
        for (int i = 0; i < 3000; ++i) {
            std::string mutated = original;
            for (unsigned edits = 1 + static_cast<unsigned>(random()) % 4; edits > 0; --edits) {
                // Mostly in the header, where damage is interesting.
                const std::size_t reach =
                    random() % 2 ? std::min<std::size_t>(mutated.size(), 130) : mutated.size();
                const std::size_t at = reach == 0 ? 0 : random() % reach;
                switch (mutated.empty() ? 2 : random() % 4) {
                case 0:
                    mutated[at] = static_cast<char>(random());
                    break;
                case 1:
                    mutated.erase(at, 1 + random() % 5);
                    break;
                case 2:
                    mutated.insert(at, std::to_string(random()));
                    break;
                default:
                    mutated.resize(at);
                    break;
                }
            }
            // File systems flush a file that is cut and written again, which takes milliseconds.
            std::filesystem::remove(mFolder / name);
            test::writeBytes(mFolder / name, mutated);
            const auto read = readGrid(mFolder / name);
            errors += !read;
            const std::size_t bytes = read ? read->words().size() * 4 : 0;
            EXPECT_LE(bytes, (std::size_t{512} << 20) + 32 * mutated.size());
            EXPECT_TRUE(read || !read.error().text.empty());
        }
        EXPECT_GT(errors, 1000);
    }
}

} // namespace
} // namespace lamina
