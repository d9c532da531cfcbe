#include "gl/shader_library.hpp"
#include "gl/shader_source.hpp"
#include "support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

// What the GLSL compiler sees must be C++ too.
#include "shader_fixtures/good/lamina/shared/constants.glsl"
static_assert(sizeof(fixture::FixtureConstants) == 16 && FIXTURE_WORD_BITS == 32);

namespace lamina::gl {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

ShaderReader reader(std::map<std::string, std::string> sources) {
    return [sources = std::move(sources)](std::string_view name) -> std::optional<std::string> {
        const auto found = sources.find(std::string(name));
        return found == sources.end() ? std::nullopt : std::optional(found->second);
    };
}

std::size_t countOf(std::string_view part, std::string_view text) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string_view::npos;
         at = text.find(part, at + 1))
        ++count;
    return count;
}

/// Where a GLSL 4.50 compiler sees the first line that contains `part`, for one that obeys `#line N
/// S` and one that, like Mesa, forgets S: the line after the directive is line N of source S.
std::string placeOf(std::string_view part, const ShaderText& shader) {
    std::istringstream lines(shader.text);
    std::size_t source = 0;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line); ++number) {
        if (line.starts_with("#line ")) {
            std::istringstream(line.substr(6)) >> number >> source;
            --number;
        } else if (line.find(part) != std::string::npos) {
            const std::string place = describePlace(source, number, shader.files);
            EXPECT_EQ(describePlace(0, number, shader.files), place);
            EXPECT_TRUE(place.starts_with(shader.files.at(source) + ":")) << place;
            return place;
        }
    }
    return "nowhere";
}

std::string flattenError(std::map<std::string, std::string> sources) {
    const auto shader = flattenShader("a.frag", reader(std::move(sources)));
    return shader ? "no error" : shader.error().text;
}

TEST(FlattenShader, KeepsEveryLinesPlace) {
    const auto shader = flattenShader(
        "a.frag", reader({{"a.frag", "#version 450 core\none\n#include <x.glsl>\n\nfive\n"},
                          {"x.glsl", "x1\n  #  include <y.glsl> // why\nx3\nx4"},
                          {"y.glsl", "y1\r\ny2\r\n"}}));
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_THAT(shader->files, ElementsAre("a.frag", "x.glsl", "y.glsl"));
    EXPECT_EQ(placeOf("one", *shader), "a.frag:2");
    EXPECT_EQ(placeOf("five", *shader), "a.frag:5");
    EXPECT_EQ(placeOf("x1", *shader), "x.glsl:1");
    EXPECT_EQ(placeOf("x3", *shader), "x.glsl:3");
    EXPECT_EQ(placeOf("x4", *shader), "x.glsl:4");
    EXPECT_EQ(placeOf("y2", *shader), "y.glsl:2");
    EXPECT_THAT(shader->text, Not(HasSubstr("include")));
    EXPECT_THAT(shader->text, Not(HasSubstr("#version")));
    EXPECT_LT(shader->text.find("y2"), shader->text.find("x3"));
}

TEST(FlattenShader, IncludesEachFileOnce) {
    const auto shader = flattenShader(
        "a.frag",
        reader({{"a.frag", "#include <x.glsl>\n#include <y.glsl>\n#include <x.glsl>\nend\n"},
                {"x.glsl", "#pragma once\n#include <y.glsl>\nx\n"},
                {"y.glsl", "unique\n"}}));
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_EQ(countOf("unique", shader->text), 1U);
    EXPECT_EQ(shader->files.size(), 3U);
    EXPECT_EQ(placeOf("end", *shader), "a.frag:4");
    EXPECT_THAT(shader->text, Not(HasSubstr("pragma")));
}

TEST(FlattenShader, NamesTheCycle) {
    EXPECT_EQ(flattenError({{"a.frag", "\n#include <x.glsl>\n"},
                            {"x.glsl", "\n\n#include <y.glsl>\n"},
                            {"y.glsl", "#include <x.glsl>\n"}}),
              "y.glsl:1: error: #include <x.glsl>: expected no cycle, found "
              "x.glsl -> y.glsl -> x.glsl");
    EXPECT_THAT(flattenError({{"a.frag", "#include <a.frag>\n"}}), HasSubstr("a.frag -> a.frag"));
}

TEST(FlattenShader, NamesTheMissingFile) {
    EXPECT_THAT(
        flattenError({{"a.frag", "\n#include <x.glsl>\n"}, {"x.glsl", "#include <z.glsl>"}}),
        AllOf(StartsWith("x.glsl:1: error: #include <z.glsl>: "), HasSubstr("found none")));
    EXPECT_THAT(flattenError({}), StartsWith("shader a.frag: expected a source"));
}

TEST(FlattenShader, RefusesWhatItWouldGetWrong) {
    EXPECT_THAT(flattenError({{"a.frag", "#if A\n#include <x.glsl>\n#endif\n"}, {"x.glsl", ""}}),
                StartsWith("a.frag:2: error: #include <x.glsl>: expected outside of any #if"));
    EXPECT_THAT(flattenError({{"a.frag", "#include \"x.glsl\"\n"}, {"x.glsl", ""}}),
                StartsWith("a.frag:1: error: #include: expected <path"));
    EXPECT_THAT(flattenError({{"a.frag", "\n#version 460 core\n"}}),
                StartsWith("a.frag:2: error: #version: expected 450 core, found 460 core"));
    EXPECT_THAT(
        flattenError({{"a.frag", "#include <x.glsl>\n#endif\n"}, {"x.glsl", "\n#ifdef A\n"}}),
        StartsWith("x.glsl:2: error: expected an #endif"));
}

TEST(FlattenShader, AllowsIncludesInsideAnIncludeGuard) {
    const auto shader = flattenShader(
        "a.frag",
        reader({{"a.frag", "#include <x.glsl>\n#include <x.glsl>\n"},
                {"x.glsl", "// x\n#ifndef X_GLSL\n#define X_GLSL\n#include <y.glsl>\n#endif\n"},
                {"y.glsl", "y\n"}}));
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_EQ(placeOf("y", *shader), "y.glsl:1");
    // A default value is no guard: the engine may have defined the name.
    EXPECT_THAT(flattenError({{"a.frag", "#ifndef N\n#define N 1\n#include <y.glsl>\n#endif\n"},
                              {"y.glsl", ""}}),
                StartsWith("a.frag:3: error"));
}

TEST(FlattenShader, LeavesCommentsAlone) {
    const auto shader = flattenShader(
        "a.frag", reader({{"a.frag", "// #include <x.glsl>\n/*\n#include <x.glsl>\n*/ kept\n"}}));
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_EQ(placeOf("kept", *shader), "a.frag:4");
    EXPECT_EQ(countOf("#include <x.glsl>", shader->text), 2U);
}

TEST(FlattenShader, DropsWhatIsOnlyForCpp) {
    const auto shader = flattenShader(
        "a.glsl",
        reader({{"a.glsl", "#ifdef __cplusplus\n#include <glm/vec4.hpp>\n#if 1\ncpp\n"
                           "#endif\n#else\nglsl\n#if A\ntrue\n#else\nfalse\n#endif\n"
                           "#endif\n#if !defined( __cplusplus )\nmore\n#endif\nlast\n"}}));
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_THAT(shader->text, Not(HasSubstr("cpp\n")));
    EXPECT_THAT(shader->text, Not(HasSubstr("glm")));
    EXPECT_THAT(shader->text, Not(HasSubstr("__cplusplus")));
    EXPECT_EQ(countOf("#if", shader->text), 1U);
    EXPECT_EQ(countOf("#endif", shader->text), 1U);
    EXPECT_EQ(placeOf("glsl", *shader), "a.glsl:7");
    EXPECT_THAT(shader->text, AllOf(HasSubstr("true\n#else\nfalse"), HasSubstr("more")));
    EXPECT_EQ(placeOf("last", *shader), "a.glsl:17");
}

TEST(Permutations, AreParsed) {
    const auto axes = parsePermutations("a.frag", "#version 450 core\n"
                                                  "// permute COVERAGE = 0 1 2\n"
                                                  "  //permute MODE=FAST SLOW\n"
                                                  "// the permute word in prose\n");
    ASSERT_TRUE(axes) << axes.error().text;
    EXPECT_THAT(*axes, ElementsAre(PermutationAxis{"COVERAGE", {"0", "1", "2"}},
                                   PermutationAxis{"MODE", {"FAST", "SLOW"}}));
}

TEST(Permutations, ErrorsNameTheLine) {
    for (const char* line : {"// permute COVERAGE", "// permute COVERAGE =", "// permute = 1",
                             "// permute 2D = 1", "// permute"}) {
        const auto axes = parsePermutations("a.frag", std::string("\n") + line + "\n");
        ASSERT_FALSE(axes) << line;
        EXPECT_THAT(axes.error().text, StartsWith("a.frag:2: error: permute: expected")) << line;
    }
    const auto twice = parsePermutations("a.frag", "// permute A = 1\n// permute A = 2");
    ASSERT_FALSE(twice);
    EXPECT_THAT(twice.error().text,
                StartsWith("a.frag:2: error: permute: expected each name once"));
}

TEST(Permutations, CrossProduct) {
    EXPECT_EQ(expandPermutations({}).size(), 1U);
    const std::vector<PermutationAxis> axes = {{"A", {"0", "1"}}, {"B", {"x", "y", "z"}}};
    const auto all = expandPermutations(axes);
    ASSERT_EQ(all.size(), 6U);
    EXPECT_THAT(all[0], ElementsAre(ShaderDefine{"A", "0"}, ShaderDefine{"B", "x"}));
    EXPECT_THAT(all[5], ElementsAre(ShaderDefine{"A", "1"}, ShaderDefine{"B", "z"}));
}

TEST(Assemble, PutsVersionAndDefinesFirst) {
    const std::vector<ShaderDefine> defines = {{"A", "1"}, {"B", "vec2(0)"}};
    EXPECT_EQ(assemble({"#line 1 0\nbody\n", {"a.frag"}}, defines),
              "#version 450 core\n#define A 1\n#define B vec2(0)\n#line 1 0\nbody\n");
}

TEST(TranslateLog, KnowsEveryDriversForm) {
    const std::vector<std::string> files = {"voxelize/a.frag", "lamina/x.glsl"};
    EXPECT_EQ(translateLog("1:12(5): error: `y' undeclared\n", files),
              "lamina/x.glsl:12: error: `y' undeclared\n");
    EXPECT_EQ(translateLog("0(7) : error C1503: undefined variable", files),
              "voxelize/a.frag:7: error C1503: undefined variable");
    EXPECT_EQ(translateLog("ERROR: 1:3: 'y' : undeclared\nWARNING: 0:4: odd\n", files),
              "lamina/x.glsl:3: error: 'y' : undeclared\nvoxelize/a.frag:4: warning: odd\n");
    // The source number is also in the line number, which Mesa reports reliably.
    EXPECT_EQ(translateLog("0:100012(5): error: y", files), "lamina/x.glsl:12: error: y");
    // No place, or one of no file of ours.
    for (const char* line : {"error: linking failed", "2:1(1): error: y", "10: x", "1:x", "1(2: x",
                             "99999999999999999999:1: x", "0:200001: x", "", "\n"})
        EXPECT_EQ(translateLog(line, files), line);
}

TEST(ShaderLibrary, EmbedsTheTreeAsItIs) {
    const EmbeddedShader* words = findEmbeddedShader("lamina/words.glsl");
    ASSERT_NE(words, nullptr);
    std::ifstream file(LAMINA_SHADER_FIXTURES "/good/lamina/words.glsl", std::ios::binary);
    EXPECT_EQ(words->source, std::string(std::istreambuf_iterator<char>(file), {}));
    EXPECT_EQ(findEmbeddedShader("lamina/word.glsl"), nullptr);
    EXPECT_EQ(findEmbeddedShader(""), nullptr);
    for (const EmbeddedShader& shader : embeddedShaders())
        EXPECT_EQ(findEmbeddedShader(shader.name), &shader);
}

TEST(ShaderLibrary, EmbedsLargeSourcesAndEveryByte) {
    const EmbeddedShader* large = findEmbeddedShader("lamina/large.glsl");
    ASSERT_NE(large, nullptr);
    EXPECT_GT(large->source.size(), 200'000U);
    EXPECT_THAT(std::string(large->source.substr(large->source.size() - 20)), EndsWith("// end\n"));
    std::string everyByte;
    for (int byte = 1; byte < 256; ++byte)
        everyByte.push_back(static_cast<char>(byte));
    EXPECT_NE(large->source.find(everyByte), std::string_view::npos);
}

TEST(ShaderLibrary, LoadsFlattened) {
    const auto shader = loadShader("voxelize/slices.frag");
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_THAT(shader->files, ElementsAre("voxelize/slices.frag", "lamina/words.glsl",
                                           "lamina/bits.glsl", "lamina/shared/constants.glsl"));
    EXPECT_EQ(countOf("uint bitOf(", shader->text), 1U);
    const auto unknown = loadShader("voxelize/none.frag");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, ErrorCode::NotFound);
    EXPECT_THAT(unknown.error().text, HasSubstr("voxelize/none.frag"));
}

TEST(ShaderLibrary, OverrideDirectoryReplacesSingleFiles) {
    const test::TemporaryFolder root;
    std::filesystem::create_directories(root / "lamina");
    test::writeBytes(root / "lamina/bits.glsl", "uint bitOf(int slice) { return 7u; }\n");
    const auto shader = loadShader("voxelize/slices.frag", root.path().string());
    std::filesystem::remove_all(root.path());
    ASSERT_TRUE(shader) << shader.error().text;
    EXPECT_THAT(shader->text, HasSubstr("return 7u"));
    EXPECT_THAT(shader->text, HasSubstr("uvec4 wordsOf("));
    EXPECT_THAT(shader->text, Not(HasSubstr("FIXTURE_WORD_BITS;")));

    const auto embedded = loadShader("voxelize/slices.frag", root.path().string());
    ASSERT_TRUE(embedded) << "a directory that does not exist overrides nothing";
    EXPECT_THAT(embedded->text, Not(HasSubstr("return 7u")));
}

TEST(ReadFrom, StaysBelowItsRoot) {
    const ShaderReader read = readFrom(LAMINA_SHADER_FIXTURES "/good");
    EXPECT_TRUE(read("lamina/bits.glsl"));
    EXPECT_FALSE(read("../good/lamina/bits.glsl"));
    EXPECT_FALSE(read("lamina/../../good/lamina/bits.glsl"));
    EXPECT_FALSE(read(LAMINA_SHADER_FIXTURES "/good/lamina/bits.glsl"));
    EXPECT_FALSE(read("lamina"));
}

} // namespace
} // namespace lamina::gl
