#include "grid_fixture.hpp"

#include <lamina/grid_io/image.hpp>

#include <gmock/gmock.h>

namespace lamina {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using namespace std::string_literals;

Image noise(std::uint32_t width, std::uint32_t height, bool opaque) {
    std::mt19937 random(11);
    Image image{width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height)};
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
        image.rgba[i] = opaque && i % 4 == 3 ? 255 : static_cast<std::uint8_t>(random());
    return image;
}

/// The number at a byte of the file's first chunk, big-endian as the format says.
std::uint32_t headerNumber(const std::string& file, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<unsigned char>(file[at + i]);
    return value;
}

/// The checksum of PNG chunks, bit by bit from its definition.
std::uint32_t checksum(const std::string& bytes) {
    std::uint32_t rest = ~0u;
    for (const char byte : bytes) {
        rest ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit)
            rest = rest >> 1 ^ (rest & 1u ? 0xedb88320u : 0u);
    }
    return ~rest;
}

/// A correct PNG whose header claims another size.
std::string withSize(std::string file, const std::string& widthAndHeight) {
    file.replace(16, 8, widthAndHeight);
    const std::uint32_t sum = checksum(file.substr(12, 17));
    for (int i = 0; i < 4; ++i)
        file[29 + static_cast<std::size_t>(i)] = static_cast<char>(sum >> (24 - 8 * i));
    return file;
}

TEST(Png, KeepsEveryPixel) {
    TemporaryFolder folder;
    for (const bool opaque : {true, false}) {
        const Image image = noise(37, 5, opaque);
        ASSERT_TRUE(writePng(folder / "a.png", image));
        const auto read = readPng(folder / "a.png");
        ASSERT_TRUE(read) << read.error().text;
        EXPECT_EQ(read->width, 37u);
        EXPECT_EQ(read->height, 5u);
        EXPECT_EQ(read->rgba, image.rgba);
    }
}

TEST(Png, HasAlphaOnlyWhereNeeded) {
    TemporaryFolder folder;
    for (const bool opaque : {true, false}) {
        ASSERT_TRUE(writePng(folder / "a.png", noise(300, 2, opaque)));
        const std::string file = test::readBytes(folder / "a.png");
        ASSERT_GT(file.size(), 33u);
        EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
        EXPECT_EQ(headerNumber(file, 16), 300u);
        EXPECT_EQ(headerNumber(file, 20), 2u);
        EXPECT_EQ(file[24], 8);              // Bits a channel.
        EXPECT_EQ(file[25], opaque ? 2 : 6); // RGB or RGBA.
    }
}

TEST(Png, PixelIsTheUpperLeftFirst) {
    Image image{2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}};
    EXPECT_THAT(image.pixel(1, 0), testing::ElementsAre(5, 6, 7, 8));
    EXPECT_THAT(image.pixel(0, 1), testing::ElementsAre(9, 10, 11, 12));
}

TEST(Png, RefusesInconsistentImages) {
    TemporaryFolder folder;
    for (const Image& image : {Image{0, 0, {}}, Image{2, 2, std::vector<std::uint8_t>(15)},
                               Image{0, 4, std::vector<std::uint8_t>(16)}}) {
        const auto written = writePng(folder / "a.png", image);
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code, ErrorCode::InvalidArgument);
    }
    EXPECT_EQ(folder.names().size(), 0u);
    EXPECT_EQ(writePng(folder / "nowhere/a.png", noise(2, 2, true)).error().code,
              ErrorCode::NotFound);
}

TEST(Png, NamesWhatIsWrongWithAFile) {
    TemporaryFolder folder;
    ASSERT_TRUE(writePng(folder / "good.png", noise(64, 64, true)));
    const std::string good = test::readBytes(folder / "good.png");
    EXPECT_EQ(readPng(folder / "none.png").error().code, ErrorCode::NotFound);
    const std::string same = withSize(good, "\x00\x00\x00\x40\x00\x00\x00\x40"s);
    ASSERT_TRUE(same == good);
    const std::string huge = withSize(good, "\x00\x0f\x00\x00\x00\x0f\x00\x00"s);
    for (const std::string& content :
         {""s, "text"s, good.substr(0, 20), good.substr(0, good.size() / 2), huge}) {
        test::writeBytes(folder / "bad.png", content);
        const auto image = readPng(folder / "bad.png");
        ASSERT_FALSE(image) << content.size();
        EXPECT_EQ(image.error().code, ErrorCode::InvalidFile) << image.error().text;
        EXPECT_THAT(image.error().text, HasSubstr("expected a PNG picture, found: "));
    }
}

} // namespace
} // namespace lamina
