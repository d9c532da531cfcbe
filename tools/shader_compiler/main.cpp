// lamina_shader_compiler --root DIR [--programs FILE] [--output FILE.cpp [--depfile FILE.d]]
//
// Compiles every permutation of every shader under DIR, links every program of the list
// (default: DIR/programs.txt if it exists), and writes the sources as C++.
// Exit status: 0; 1 after "path:line: error: message" lines on standard error; 2 for bad usage.

#include "embed.hpp"
#include "glsl_check.hpp"
#include "shader_tree.hpp"

#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>

namespace {

using namespace lamina;
using namespace lamina::tools;
namespace fs = std::filesystem;

struct Options {
    fs::path root;
    fs::path programs;
    fs::path output;
    fs::path depfile;
};

bool parseOptions(int count, char** arguments, Options& options) {
    for (int i = 1; i < count; i += 2) {
        const std::string option = arguments[i];
        if (i + 1 == count)
            return false;
        const fs::path value = arguments[i + 1];
        if (option == "--root")
            options.root = value;
        else if (option == "--programs")
            options.programs = value;
        else if (option == "--output")
            options.output = value;
        else if (option == "--depfile")
            options.depfile = value;
        else
            return false;
    }
    std::error_code ignored;
    if (options.programs.empty() && fs::exists(options.root / "programs.txt", ignored))
        options.programs = options.root / "programs.txt";
    return !options.root.empty();
}

int fail(const fs::path& root, const std::string& diagnostic) {
    // Names are below the root, unless the diagnostic is about the program list or the root itself.
    const fs::path path = diagnostic.substr(0, diagnostic.find(':'));
    const bool isName = path.is_relative() && fs::exists(root / path);
    std::cerr << (isName ? (root / diagnostic).string() : diagnostic) << '\n';
    return 1;
}

bool writeFile(const fs::path& path, const std::string& text) {
    const fs::path partial = path.string() + ".partial";
    std::ofstream file(partial, std::ios::binary);
    file << text;
    file.close();
    std::error_code failure;
    if (file)
        fs::rename(partial, path, failure);
    if (file && !failure)
        return true;
    std::cerr << path.string() << ": error: cannot be written\n";
    return false;
}

std::string readFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
}

int run(const Options& options) {
    const Result<ShaderTree> tree = readShaderTree(options.root);
    if (!tree)
        return fail(options.root, tree.error().text);

    GlslChecker checker(*tree);
    checker.checkSources();
    if (!checker.hasErrors() && !options.programs.empty()) {
        const std::string name = options.programs.string();
        const auto programs = parsePrograms(name, readFile(options.programs), *tree);
        if (!programs)
            return fail(options.root, programs.error().text);
        for (const ProgramDeclaration& program : *programs)
            checker.checkProgram(name, program);
    }
    for (const std::string& diagnostic : checker.diagnostics())
        fail(options.root, diagnostic);
    if (checker.hasErrors())
        return 1;

    std::cout << "shaders: " << tree->size() << " sources, " << checker.compiledCount()
              << " permutations compiled, " << checker.linkedCount() << " programs linked\n";
    if (!options.output.empty() && !writeFile(options.output, embeddedSource(*tree)))
        return 1;
    if (!options.depfile.empty() &&
        !writeFile(options.depfile,
                   dependencyFile(options.output, options.root, *tree, options.programs)))
        return 1;
    return 0;
}

} // namespace

int main(int count, char** arguments) {
    Options options;
    if (!parseOptions(count, arguments, options)) {
        std::cerr << "usage: lamina_shader_compiler --root DIR [--programs FILE] "
                     "[--output FILE.cpp [--depfile FILE.d]]\n";
        return 2;
    }
    return run(options);
}
