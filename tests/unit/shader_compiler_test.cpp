// Runs the build's shader compiler as the build does, on fixture trees with known mistakes.

#include "support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sys/wait.h>

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kFixtures = LAMINA_SHADER_FIXTURES;

struct Outcome {
    int status = -1;
    std::string output;
};

Outcome compile(const std::string& root, const std::string& options = {}) {
    const std::string command =
        "\"" LAMINA_SHADER_COMPILER "\" --root \"" + root + "\" " + options + " 2>&1";
    Outcome outcome;
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe)
        return outcome;
    std::array<char, 4096> buffer{};
    while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
        outcome.output.append(buffer.data(), count);
    outcome.status = WEXITSTATUS(pclose(pipe));
    return outcome;
}

class ScratchTree : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories((mRoot / name).parent_path());
        lamina::test::writeBytes(mRoot / name, text);
    }
    [[nodiscard]] std::string at(const std::string& name) const { return (mRoot / name).string(); }
    [[nodiscard]] Outcome compileScratch(const std::string& options = {}) const {
        return compile(mRoot.path().string(), options);
    }

    const lamina::test::TemporaryFolder mRoot;
};

const std::string kVertex = "void main() { gl_Position = vec4(0.0); }\n";

TEST(ShaderCompiler, CompilesEveryPermutationAndLinksEveryProgram) {
    const Outcome outcome = compile(kFixtures + "/good");
    EXPECT_EQ(outcome.status, 0);
    // mesh.vert 1, slices.geom 2, slices.frag 4, count.comp 1, unreached.glsl 2;
    // slices 2 x 2 (one SLICE_WORDS for both stages), count 1.
    EXPECT_THAT(outcome.output,
                HasSubstr("8 sources, 10 permutations compiled, 5 programs linked"));
}

TEST(ShaderCompiler, ErrorNamesFileLineAndPermutation) {
    const Outcome outcome = compile(kFixtures + "/broken_entry");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output,
                AllOf(StartsWith(kFixtures + "/broken_entry/voxelize/entry.frag:8: error: "),
                      HasSubstr("[INVERT=1]")));
}

TEST(ShaderCompiler, ErrorInsideAnIncludeNamesTheInclude) {
    const Outcome outcome = compile(kFixtures + "/broken_include");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output,
                AllOf(StartsWith(kFixtures + "/broken_include/lamina/inner.glsl:6: error: "),
                      HasSubstr("missing")));
}

TEST(ShaderCompiler, TypeMismatchBetweenStages) {
    const Outcome outcome = compile(kFixtures + "/broken_link");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.output,
              kFixtures +
                  "/broken_link/voxelize/stage.frag:7: error: input normal is vec4, "
                  "but the output normal at voxelize/stage.vert:6 is vec3 [program mismatch]\n");
}

TEST(ShaderCompiler, InputThatNothingFeeds) {
    const Outcome outcome = compile(kFixtures + "/missing_output");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(
        outcome.output,
        AllOf(StartsWith(kFixtures +
                         "/missing_output/voxelize/stage.frag:7: error: input shade is vec4"),
              HasSubstr("no output at location 1"), Not(HasSubstr("unused"))));
}

TEST(ShaderCompiler, UniformBlockMismatchNamesTheProgramsLine) {
    const Outcome outcome = compile(kFixtures + "/broken_uniform");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output,
                AllOf(StartsWith(kFixtures + "/broken_uniform/programs.txt:3: error: "),
                      HasSubstr("Grid")));
}

TEST_F(ScratchTree, MissingIncludeAndCycle) {
    write("voxelize/a.comp",
          "layout(local_size_x = 1) in;\n#include <lamina/none.glsl>\nvoid main() {}\n");
    EXPECT_THAT(compileScratch().output,
                StartsWith(at("voxelize/a.comp") + ":2: error: #include <lamina/none.glsl>"));
    write("lamina/none.glsl", "\n#include <lamina/none.glsl>\n");
    const Outcome outcome = compileScratch();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output, StartsWith(at("lamina/none.glsl") + ":2: error: "));
}

TEST_F(ScratchTree, IncludeThatNoEntryPointReachesIsCompiledToo) {
    write("lamina/alone.glsl", "float f() {\n    return nothing;\n}\n");
    const Outcome outcome = compileScratch();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output, StartsWith(at("lamina/alone.glsl") + ":2: error: "));
}

TEST_F(ScratchTree, ProgramListMistakes) {
    write("a.vert", kVertex);
    write("programs.txt", "# list\na: a.vert b.frag\n");
    EXPECT_THAT(
        compileScratch().output,
        AllOf(StartsWith(at("programs.txt") + ":2: error: program a"), HasSubstr("found b.frag")));
    write("programs.txt", "a a.vert\n");
    EXPECT_THAT(compileScratch().output,
                StartsWith(at("programs.txt") + ":1: error: expected NAME:"));
    write("programs.txt", "a:\n");
    EXPECT_EQ(compileScratch().status, 1);
}

TEST_F(ScratchTree, StagesMustAgreeOnTheValuesOfAnAxis) {
    write("a.vert", "// permute A = 0 1\n" + kVertex);
    write("a.frag", "// permute A = 0 2\nvoid main() {}\n");
    write("programs.txt", "a: a.vert a.frag\n");
    const Outcome outcome = compileScratch();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output,
                AllOf(StartsWith(at("programs.txt") + ":1: error: "), HasSubstr("values of A")));
}

TEST_F(ScratchTree, MismatchInOnePermutationOnly) {
    write("a.vert", "// permute WIDE = 0 1\n#if WIDE\nout vec4 v;\n#else\nout vec3 v;\n#endif\n"
                    "void main() {\n#if WIDE\n v = vec4(0.0);\n#else\n v = vec3(0.0);\n#endif\n"
                    " gl_Position = vec4(0.0);\n}\n");
    write("a.frag",
          "in vec3 v;\nlayout(location = 0) out vec4 color;\nvoid main() { color = v.xyzz; }\n");
    write("programs.txt", "a: a.vert a.frag\n");
    const Outcome outcome = compileScratch();
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output, AllOf(StartsWith(at("a.frag") + ":3: error: input v is vec3"),
                                      HasSubstr("a.vert:9 is vec4"), HasSubstr("[WIDE=1]")));
}

TEST_F(ScratchTree, WritesNothingOnError) {
    write("tree/a.vert", "broken\n");
    const Outcome outcome =
        compile(at("tree"), "--output \"" + at("out.cpp") + "\" --depfile \"" + at("out.d") + "\"");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_FALSE(std::filesystem::exists(at("out.cpp")));
    EXPECT_FALSE(std::filesystem::exists(at("out.d")));
}

TEST_F(ScratchTree, DepfileNamesEverySource) {
    write("tree/a.vert", "#include <lamina/x.glsl>\n" + kVertex);
    write("tree/lamina/x.glsl", "float x() { return 1.0; }\n");
    write("tree/programs.txt", "a: a.vert\n");
    const Outcome outcome =
        compile(at("tree"), "--output \"" + at("out.cpp") + "\" --depfile \"" + at("out.d") + "\"");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    std::ifstream file(at("out.d"));
    const std::string rule(std::istreambuf_iterator<char>(file), {});
    EXPECT_THAT(rule, StartsWith(at("out.cpp") + ":"));
    for (const char* name : {"tree/a.vert", "tree/lamina/x.glsl", "tree/programs.txt"})
        EXPECT_THAT(rule, HasSubstr(at(name)));
}

TEST_F(ScratchTree, EmptyTreeAndMissingRoot) {
    EXPECT_EQ(compileScratch("--output \"" + at("out.cpp") + "\"").status, 0);
    EXPECT_TRUE(std::filesystem::exists(at("out.cpp")));
    const Outcome outcome = compile(at("none"));
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output, HasSubstr(at("none") + ": error: "));
    EXPECT_EQ(compile(at(""), "--colour blue").status, 2);
}

} // namespace
