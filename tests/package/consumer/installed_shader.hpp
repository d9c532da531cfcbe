#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

/// A host's own `#include <...>`: shader text with the files of Lamina's installed shader folder in
/// place.
inline std::string installedShader(const std::string& folder, const std::string& source) {
    constexpr std::string_view kInclude = "#include <";
    std::istringstream lines(source);
    std::string text;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with(kInclude)) {
            text += line + '\n';
            continue;
        }
        const std::string name = line.substr(kInclude.size(), line.rfind('>') - kInclude.size());
        std::ifstream file(folder + '/' + name);
        if (!file.good()) {
            std::fprintf(stderr, "expected an installed shader %s\n", name.c_str());
            std::exit(1);
        }
        text += installedShader(folder, {std::istreambuf_iterator<char>(file), {}});
    }
    return text;
}
