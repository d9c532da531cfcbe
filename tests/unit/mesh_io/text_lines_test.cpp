#include "mesh_io/text_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lamina::detail {
namespace {

std::vector<std::string> linesOf(std::string_view text) {
    std::vector<std::string> lines;
    for (TextLines reader(text); reader.next();)
        lines.push_back(std::to_string(reader.number()) + ":" + std::string(reader.line()));
    return lines;
}

TEST(TextLines, SplitsAtAnyLineEnd) {
    EXPECT_THAT(linesOf(""), testing::IsEmpty());
    EXPECT_THAT(linesOf("\n"), testing::ElementsAre("1:"));
    EXPECT_THAT(linesOf("a\nb"), testing::ElementsAre("1:a", "2:b"));
    EXPECT_THAT(linesOf("a\r\nb\rc\n\rd\r\r\n"),
                testing::ElementsAre("1:a", "2:b", "3:c", "4:", "5:d", "6:"));
    EXPECT_THAT(linesOf("\xEF\xBB\xBFx\n"), testing::ElementsAre("1:x"));
}

TEST(TextLines, JoinsContinuedLines) {
    TextLines lines("a\\\nb\\\r\nc\nd\\");
    ASSERT_TRUE(lines.nextJoined());
    EXPECT_EQ(lines.line(), "a b c");
    EXPECT_EQ(lines.number(), 1u);
    ASSERT_TRUE(lines.nextJoined());
    EXPECT_EQ(lines.line(), "d ");
    EXPECT_EQ(lines.number(), 4u);
    EXPECT_FALSE(lines.nextJoined());
}

TEST(TextLines, NextContentSkipsBlanksAndComments) {
    TextLines lines("\n  \n# all\n x # rest\n");
    ASSERT_TRUE(lines.nextContent('#'));
    EXPECT_EQ(lines.line(), " x ");
    EXPECT_EQ(lines.number(), 4u);
    EXPECT_FALSE(lines.nextContent('#'));
}

TEST(ParseReal, WholeWordsOnly) {
    EXPECT_EQ(parseReal<float>("+1.5e1"), 15.0f);
    EXPECT_EQ(parseReal<float>("-.5"), -0.5f);
    EXPECT_EQ(parseReal<float>("5."), 5.0f);
    EXPECT_EQ(parseReal<float>("0.1"), 0.1f);
    EXPECT_TRUE(std::isnan(*parseReal<float>("nan")));
    EXPECT_EQ(parseReal<double>("-inf"), -std::numeric_limits<double>::infinity());
    for (const char* word : {"", "+", "-", ".", "+-1", "1x", "1,5", "0x10", "1e", "--1", "1 "})
        EXPECT_FALSE(parseReal<float>(word)) << word;
}

TEST(ParseReal, OutOfRange) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(parseReal<float>("1e39"), static_cast<float>(kInfinity));
    EXPECT_EQ(parseReal<float>("-1e39"), static_cast<float>(-kInfinity));
    EXPECT_EQ(parseReal<float>("1e-60"), 0.0f);
    EXPECT_EQ(parseReal<double>("1e99999999999999999999"), kInfinity);
    EXPECT_EQ(parseReal<double>("1e-99999999999999999999"), 0.0);
    EXPECT_EQ(parseReal<double>("0." + std::string(400, '0') + "1"), 0.0);
    EXPECT_EQ(parseReal<double>(std::string(400, '9')), kInfinity);
    EXPECT_EQ(parseReal<double>(std::string(400, '9') + "e-90"), kInfinity);
    EXPECT_EQ(parseReal<double>("0e999999"), 0.0);
}

TEST(ParseInteger, WholeWordsOnly) {
    EXPECT_EQ(parseInteger<std::int64_t>("-12"), -12);
    EXPECT_EQ(parseInteger<std::int64_t>("+12"), 12);
    EXPECT_EQ(parseInteger<std::uint64_t>("18446744073709551615"), 18446744073709551615u);
    for (const char* word : {"", "1.0", "x", "-", "18446744073709551616"})
        EXPECT_FALSE(parseInteger<std::uint64_t>(word)) << word;
}

} // namespace
} // namespace lamina::detail
