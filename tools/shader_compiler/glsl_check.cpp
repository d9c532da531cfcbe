#include "glsl_check.hpp"

#include "interface_check.hpp"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>

namespace lamina::tools {
namespace {

EShLanguage stageOf(std::string_view name) {
    static const std::map<std::string, EShLanguage, std::less<>> kStages = {
        {"vert", EShLangVertex},   {"tesc", EShLangTessControl}, {"tese", EShLangTessEvaluation},
        {"geom", EShLangGeometry}, {"frag", EShLangFragment},    {"comp", EShLangCompute}};
    const auto stage = kStages.find(name.substr(name.rfind('.') + 1));
    return stage == kStages.end() ? EShLangFragment : stage->second;
}

std::unique_ptr<glslang::TShader> makeShader(std::string_view name) {
    const EShLanguage stage = stageOf(name);
    auto shader = std::make_unique<glslang::TShader>(stage);
    shader->setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientOpenGL, 450);
    shader->setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
    return shader;
}

bool parse(glslang::TShader& shader, const std::string& text) {
    const char* const strings[] = {text.c_str()};
    const int lengths[] = {static_cast<int>(text.size())};
    shader.setStringsWithLengths(strings, lengths, 1);
    return shader.parse(GetDefaultResources(), 450, ECoreProfile, false, false, EShMsgDefault);
}

bool isNoise(std::string_view line) {
    return line.empty() || line.find("compilation terminated") != std::string_view::npos ||
           line.find("No code generated") != std::string_view::npos;
}

/// glslang stops at the first error, and then misses what would have come.
bool isConsequence(std::string_view line) {
    return line.find("missing #endif") != std::string_view::npos;
}

bool declares(const std::vector<gl::PermutationAxis>& axes, const std::string& name) {
    return std::ranges::find(axes, name, &gl::PermutationAxis::name) != axes.end();
}

} // namespace

GlslChecker::GlslChecker(const ShaderTree& tree)
    : mTree(tree) {
    glslang::InitializeProcess();
}
GlslChecker::~GlslChecker() {
    glslang::FinalizeProcess();
}

void GlslChecker::checkSources() {
    std::set<std::string> reached;
    for (const auto& [name, source] : mTree) {
        if (isEntryPoint(name)) {
            for (std::string& file : checkSource(name))
                reached.insert(std::move(file));
        }
    }
    // What a broken entry point includes would look unreached.
    if (mHasErrors)
        return;
    for (const auto& [name, source] : mTree) {
        if (!isEntryPoint(name) && !reached.contains(name))
            checkSource(name);
    }
}

std::vector<std::string> GlslChecker::checkSource(const std::string& name) {
    const Result<gl::ShaderText> shader = gl::flattenShader(name, readerOf(mTree));
    const auto axes = gl::parsePermutations(name, mTree.find(name)->second);
    if (!shader || !axes) {
        report(!shader ? shader.error().text : axes.error().text);
        return {};
    }
    for (const Defines& defines : gl::expandPermutations(*axes)) {
        std::string text = gl::assemble(*shader, defines);
        if (!isEntryPoint(name))
            text += "void main() {}\n";
        const auto compiled = makeShader(name);
        if (!parse(*compiled, text))
            mHasErrors = true;
        reportLog(compiled->getInfoLog(), shader->files, name + ":1", defines);
        ++mCompiledCount;
    }
    return shader->files;
}

void GlslChecker::checkProgram(const std::string& programFile, const ProgramDeclaration& program) {
    const std::string place = programFile + ":" + std::to_string(program.line);
    std::vector<gl::ShaderText> stages;
    std::vector<std::vector<gl::PermutationAxis>> stageAxes;
    std::vector<gl::PermutationAxis> axes;
    for (const std::string& stage : program.stages) {
        Result<gl::ShaderText> text = gl::flattenShader(stage, readerOf(mTree));
        auto declared = gl::parsePermutations(stage, mTree.find(stage)->second);
        if (!text || !declared) {
            report(!text ? text.error().text : declared.error().text);
            return;
        }
        for (const gl::PermutationAxis& axis : *declared) {
            const auto known = std::ranges::find(axes, axis.name, &gl::PermutationAxis::name);
            if (known == axes.end())
                axes.push_back(axis);
            else if (*known != axis)
                report(place + ": error: program " + program.name +
                       ": expected the same values of " + axis.name +
                       " in every stage, found others in " + stage);
        }
        stages.push_back(std::move(*text));
        stageAxes.push_back(std::move(*declared));
    }
    for (const Defines& defines : gl::expandPermutations(axes)) {
        if (!linkOnce(place, program, stages, stageAxes, defines))
            return;
    }
}

bool GlslChecker::linkOnce(const std::string& place, const ProgramDeclaration& program,
                           std::span<const gl::ShaderText> stages,
                           std::span<const std::vector<gl::PermutationAxis>> axes,
                           const Defines& defines) {
    std::vector<std::unique_ptr<glslang::TShader>> shaders;
    glslang::TProgram linked;
    for (std::size_t i = 0; i < stages.size(); ++i) {
        Defines own;
        std::ranges::copy_if(defines, std::back_inserter(own), [&](const gl::ShaderDefine& define) {
            return declares(axes[i], define.name);
        });
        shaders.push_back(makeShader(program.stages[i]));
        if (!parse(*shaders.back(), gl::assemble(stages[i], own))) {
            reportLog(shaders.back()->getInfoLog(), stages[i].files, place, own);
            return false;
        }
        linked.addShader(shaders.back().get());
    }
    ++mLinkedCount;
    for (std::size_t i = 1; i < stages.size(); ++i) {
        const CompiledStage producer{shaders[i - 1]->getIntermediate(), stages[i - 1].files};
        const CompiledStage consumer{shaders[i]->getIntermediate(), stages[i].files};
        for (const std::string& error : checkInterface(producer, consumer))
            report(error + " [program " + program.name + "]", defines);
    }
    if (mHasErrors)
        return false;
    if (linked.link(EShMsgDefault))
        return true;
    reportLog(linked.getInfoLog(), {}, place, defines);
    return false;
}

void GlslChecker::reportLog(const char* log, std::span<const std::string> files,
                            const std::string& place, const Defines& defines) {
    std::vector<std::string> messages;
    std::istringstream lines(gl::translateLog(log, files));
    for (std::string line; std::getline(lines, line);) {
        if (isNoise(line) || (!messages.empty() && isConsequence(line)))
            continue;
        if (line.starts_with(' ') && !messages.empty())
            messages.back() += " " + line.substr(line.find_first_not_of(' '));
        else
            messages.push_back(line);
    }
    for (const std::string& message : messages) {
        // A message without a place of its own is given the one it belongs to.
        const bool isPlaced = message.find(": error: ") != std::string::npos ||
                              message.find(": warning: ") != std::string::npos;
        if (isPlaced)
            report(message, defines);
        else if (message.starts_with("WARNING: "))
            report(place + ": warning: " + message.substr(9), defines);
        else
            report(place + ": error: " + message.substr(message.starts_with("ERROR: ") ? 7 : 0),
                   defines);
    }
}

void GlslChecker::report(const std::string& message, const Defines& defines) {
    if (message.find(": error: ") != std::string::npos)
        mHasErrors = true;
    if (!mSeen.insert(message).second)
        return;
    std::string suffix;
    for (const gl::ShaderDefine& define : defines)
        suffix += (suffix.empty() ? " [" : " ") + define.name + "=" + define.value;
    mDiagnostics.push_back(message + (suffix.empty() ? "" : suffix + "]"));
}

} // namespace lamina::tools
