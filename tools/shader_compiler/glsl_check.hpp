#pragma once

#include "shader_tree.hpp"

#include <set>
#include <span>
#include <string>
#include <vector>

namespace lamina::tools {

/// Compiles and links the shaders of a tree with glslang, as OpenGL 4.50 core, and collects what is
/// wrong. One at a time in a process.
class GlslChecker {
public:
    explicit GlslChecker(const ShaderTree& tree);
    ~GlslChecker();
    GlslChecker(const GlslChecker&) = delete;
    GlslChecker& operator=(const GlslChecker&) = delete;

    /// Compiles every permutation of every entry point, and of every include that no entry point
    /// reaches (as a fragment shader with an empty main).
    void checkSources();

    /// Links every permutation of a program. Axes of one name in several stages take the same
    /// value.
    void checkProgram(const std::string& programFile, const ProgramDeclaration& program);

    /// "name:line: error: message [PERMUTATION]", each message once, in the order of discovery.
    [[nodiscard]] const std::vector<std::string>& diagnostics() const { return mDiagnostics; }
    [[nodiscard]] bool hasErrors() const { return mHasErrors; }
    [[nodiscard]] std::size_t compiledCount() const { return mCompiledCount; }
    [[nodiscard]] std::size_t linkedCount() const { return mLinkedCount; }

private:
    using Defines = std::vector<gl::ShaderDefine>;

    /// Returns the names of the files the source includes, itself first.
    std::vector<std::string> checkSource(const std::string& name);
    bool linkOnce(const std::string& place, const ProgramDeclaration& program,
                  std::span<const gl::ShaderText> stages,
                  std::span<const std::vector<gl::PermutationAxis>> axes, const Defines& defines);
    void reportLog(const char* log, std::span<const std::string> files, const std::string& place,
                   const Defines& defines);
    void report(const std::string& message, const Defines& defines = {});

    const ShaderTree& mTree;
    std::vector<std::string> mDiagnostics;
    std::set<std::string> mSeen;
    bool mHasErrors = false;
    std::size_t mCompiledCount = 0;
    std::size_t mLinkedCount = 0;
};

} // namespace lamina::tools
