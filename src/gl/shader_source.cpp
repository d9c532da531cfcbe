#include "gl/shader_source.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace lamina::gl {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view trim(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Cuts the first blank-separated word off `text`.
std::string_view takeWord(std::string_view& text) {
    text = trim(text);
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    text = trim(text.substr(word.size()));
    return word;
}

/// Cuts the first line, without its line feed, off `text`.
std::string_view takeLine(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return line;
}

bool endsInsideComment(std::string_view line, bool insideComment) {
    for (std::size_t i = 0; i < line.size(); ++i) {
        const std::string_view two = line.substr(i, 2);
        if (insideComment && two == "*/") {
            insideComment = false;
            ++i;
        } else if (!insideComment && two == "//") {
            return false;
        } else if (!insideComment && two == "/*") {
            insideComment = true;
            ++i;
        }
    }
    return insideComment;
}

std::string_view withoutComment(std::string_view text) {
    return trim(text.substr(0, std::min(text.find("//"), text.find("/*"))));
}

struct Directive {
    std::string_view keyword;
    std::string_view rest;
};

std::optional<Directive> parseDirective(std::string_view line) {
    line = trim(line);
    if (!line.starts_with('#'))
        return std::nullopt;
    line = trim(line.substr(1));
    const std::size_t length =
        std::min(line.find_first_not_of("abcdefghijklmnopqrstuvwxyz"), line.size());
    return Directive{line.substr(0, length), withoutComment(line.substr(length))};
}

Error errorAt(std::string_view file, std::size_t line, std::string_view message,
              ErrorCode code = ErrorCode::ShaderError) {
    std::string text(file);
    text.append(":").append(std::to_string(line)).append(": error: ").append(message);
    return Error{code, std::move(text)};
}

/// An open `#if`. The ones on __cplusplus are decided here, the others by the GLSL compiler.
struct Conditional {
    std::size_t line;
    bool onCplusplus;
    bool keepsLines;
    bool isGuard = false; ///< The include guard of its file: true whenever the file is included.
};

/// The name that guards a source against a second inclusion: its first two directives are
/// `#ifndef NAME` and `#define NAME`. Empty without one.
std::string_view findGuard(std::string_view source) {
    std::string_view name;
    bool insideComment = false;
    while (!source.empty()) {
        const std::string_view line = takeLine(source);
        const std::optional<Directive> directive =
            insideComment ? std::nullopt : parseDirective(line);
        insideComment = endsInsideComment(line, insideComment);
        if (!directive)
            continue;
        if (!name.empty())
            return directive->keyword == "define" && directive->rest == name ? name
                                                                             : std::string_view();
        if (directive->keyword != "ifndef" || directive->rest.empty())
            return {};
        name = directive->rest;
    }
    return {};
}

std::optional<bool> isTrueInGlsl(const Directive& directive) {
    std::string condition(directive.rest);
    std::erase_if(condition, [](char c) { return kBlanks.find(c) != std::string_view::npos; });
    const std::string_view keyword = directive.keyword;
    if ((keyword == "ifdef" && condition == "__cplusplus") ||
        (keyword == "if" && condition == "defined(__cplusplus)"))
        return false;
    if ((keyword == "ifndef" && condition == "__cplusplus") ||
        (keyword == "if" && condition == "!defined(__cplusplus)"))
        return true;
    return std::nullopt;
}

class Flattener {
public:
    explicit Flattener(const ShaderReader& read)
        : mRead(read) {}

    Result<ShaderText> run(std::string_view name) {
        std::optional<std::string> source = mRead(name);
        if (!source)
            return Error{ErrorCode::NotFound, "shader " + std::string(name) +
                                                  ": expected a source of the shader library, "
                                                  "found none; correct the name"};
        if (Result<void> done = append(std::string(name), *source); !done)
            return done.error();
        return std::move(mOut);
    }

private:
    /// Appends one source and, in place of its includes, those it includes.
    Result<void> append(const std::string& name, std::string_view source) {
        const std::size_t index = mOut.files.size();
        mOut.files.push_back(name);
        mOpen.push_back(name);
        writeLineDirective(1, index);

        mGuard = findGuard(source);
        std::vector<Conditional> conditionals;
        bool insideComment = false;
        std::size_t lineNumber = 0;
        while (!source.empty()) {
            const std::string_view line = takeLine(source);
            ++lineNumber;
            const std::optional<Directive> directive =
                insideComment ? std::nullopt : parseDirective(line);
            insideComment = endsInsideComment(line, insideComment);

            bool keep = true;
            if (directive) {
                Result<bool> handled = handle(*directive, name, lineNumber, conditionals);
                if (!handled)
                    return handled.error();
                keep = *handled;
            }
            if (keep && keepsLines(conditionals))
                mOut.text.append(line);
            mOut.text.push_back('\n');
            if (mIncluded) {
                mIncluded = false;
                writeLineDirective(lineNumber + 1, index);
            }
        }
        if (!conditionals.empty())
            return errorAt(name, conditionals.back().line,
                           "expected an #endif for this condition in the same file, found none");
        mOpen.pop_back();
        return {};
    }

    /// Obeys a directive that is ours. Returns whether the line is left for the GLSL compiler.
    Result<bool> handle(const Directive& directive, const std::string& name, std::size_t line,
                        std::vector<Conditional>& conditionals) {
        const std::string_view keyword = directive.keyword;
        if (keyword == "if" || keyword == "ifdef" || keyword == "ifndef") {
            const std::optional<bool> decided = isTrueInGlsl(directive);
            const bool isGuard = !std::exchange(mGuard, {}).empty();
            conditionals.push_back({line, decided.has_value(), decided.value_or(true), isGuard});
            return !decided.has_value();
        }
        if ((keyword == "else" || keyword == "elif" || keyword == "endif") && !conditionals.empty())
            return handleBranch(keyword, name, line, conditionals);
        if (!keepsLines(conditionals))
            return false;
        if (keyword == "include")
            return include(directive.rest, name, line, conditionals);
        if (keyword == "version" && directive.rest != "450 core")
            return errorAt(name, line,
                           "#version: expected 450 core, found " + std::string(directive.rest));
        return keyword != "version" && !(keyword == "pragma" && directive.rest == "once");
    }

    static Result<bool> handleBranch(std::string_view keyword, const std::string& name,
                                     std::size_t line, std::vector<Conditional>& conditionals) {
        Conditional& innermost = conditionals.back();
        const bool ours = innermost.onCplusplus;
        if (keyword == "endif")
            conditionals.pop_back();
        else if (ours && keyword == "elif")
            return errorAt(name, line,
                           "expected #else or #endif after a condition on __cplusplus, found "
                           "#elif; nest the second condition");
        else if (ours)
            innermost.keepsLines = !innermost.keepsLines;
        return !ours;
    }

    Result<bool> include(std::string_view target, const std::string& name, std::size_t line,
                         std::span<const Conditional> conditionals) {
        if (target.size() < 3 || target.front() != '<' || target.back() != '>')
            return errorAt(name, line,
                           "#include: expected <path under the shader root>, found " +
                               std::string(target));
        const std::string included(target.substr(1, target.size() - 2));
        const std::string operation = "#include <" + included + ">: ";
        if (!std::ranges::all_of(conditionals,
                                 [](const auto& c) { return c.onCplusplus || c.isGuard; }))
            return errorAt(name, line,
                           operation + "expected outside of any #if, found inside; move it to the "
                                       "top of the file (a file is included once)");
        if (std::ranges::find(mOpen, included) != mOpen.end())
            return errorAt(name, line, operation + "expected no cycle, found " + chainTo(included));
        if (std::ranges::find(mOut.files, included) != mOut.files.end())
            return false;
        const std::optional<std::string> source = mRead(included);
        if (!source)
            return errorAt(name, line,
                           operation + "expected a file under the shader root, found none; "
                                       "correct the name",
                           ErrorCode::NotFound);
        if (Result<void> done = append(included, *source); !done)
            return done.error();
        mIncluded = true;
        return false;
    }

    [[nodiscard]] std::string chainTo(const std::string& included) const {
        std::string chain;
        for (auto open = std::ranges::find(mOpen, included); open != mOpen.end(); ++open)
            chain += *open + " -> ";
        return chain + included;
    }

    static bool keepsLines(std::span<const Conditional> conditionals) {
        return std::ranges::all_of(conditionals, &Conditional::keepsLines);
    }

    void writeLineDirective(std::size_t line, std::size_t file) {
        mOut.text += "#line " + std::to_string(file * kLinesPerSource + line) + " " +
                     std::to_string(file) + "\n";
    }

    const ShaderReader& mRead;
    ShaderText mOut;
    std::vector<std::string> mOpen; ///< From the shader down to the include being read.
    std::string_view mGuard;        ///< Of the source just begun, until its `#ifndef`.
    bool mIncluded = false;         ///< The line just handled was replaced by another file.
};

bool isIdentifier(std::string_view text) {
    const auto letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    };
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    return !text.empty() && !digit(text.front()) &&
           std::ranges::all_of(text, [&](char c) { return letter(c) || digit(c); });
}

std::optional<PermutationAxis> parseAxis(std::string_view declaration) {
    const std::size_t equals = declaration.find('=');
    if (equals == std::string_view::npos)
        return std::nullopt;
    PermutationAxis axis{std::string(trim(declaration.substr(0, equals))), {}};
    std::string_view values = declaration.substr(equals + 1);
    while (!trim(values).empty())
        axis.values.emplace_back(takeWord(values));
    if (!isIdentifier(axis.name) || axis.values.empty())
        return std::nullopt;
    return axis;
}

std::optional<std::size_t> takeNumber(std::string_view& text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{})
        return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix))
        return false;
    text.remove_prefix(prefix.size());
    return true;
}

struct LogPlace {
    std::size_t source;
    std::size_t line;
};

/// Cuts "S:N(C): ", "S:N: ", "S(N) : " or "S(N): " off `text`.
std::optional<LogPlace> takePlace(std::string_view& text) {
    std::string_view rest = text;
    const std::optional<std::size_t> file = takeNumber(rest);
    if (!file)
        return std::nullopt;
    const bool parenthesis = take(rest, "(");
    if (!parenthesis && !take(rest, ":"))
        return std::nullopt;
    const std::optional<std::size_t> line = takeNumber(rest);
    if (!line || (parenthesis && !take(rest, ")")))
        return std::nullopt;
    if (!parenthesis && take(rest, "(") && (!takeNumber(rest) || !take(rest, ")")))
        return std::nullopt;
    rest = trim(rest);
    if (!take(rest, ":"))
        return std::nullopt;
    text = trim(rest);
    return LogPlace{*file, *line};
}

std::string translateLine(std::string_view line, std::span<const std::string> files) {
    std::string_view rest = line;
    std::string severity;
    if (take(rest, "ERROR: "))
        severity = "error: ";
    else if (take(rest, "WARNING: "))
        severity = "warning: ";
    const std::optional<LogPlace> place = takePlace(rest);
    const std::string origin =
        place ? describePlace(place->source, place->line, files) : std::string();
    if (origin.empty())
        return std::string(line);
    return origin + ": " + severity + std::string(rest);
}

} // namespace

ShaderReader readFrom(std::string root) {
    return [root = std::move(root)](std::string_view name) -> std::optional<std::string> {
        const std::filesystem::path relative(name);
        if (relative.is_absolute() || std::ranges::find(relative, "..") != relative.end())
            return std::nullopt;
        const std::filesystem::path path = std::filesystem::path(root) / relative;
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(path, ignored))
            return std::nullopt;
        std::ifstream file(path, std::ios::binary);
        if (!file)
            return std::nullopt;
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
}

Result<ShaderText> flattenShader(std::string_view name, const ShaderReader& read) {
    return Flattener(read).run(name);
}

Result<std::vector<PermutationAxis>> parsePermutations(std::string_view name,
                                                       std::string_view source) {
    std::vector<PermutationAxis> axes;
    for (std::size_t lineNumber = 1; !source.empty(); ++lineNumber) {
        std::string_view line = trim(takeLine(source));
        if (!take(line, "//") || takeWord(line) != "permute")
            continue;
        std::optional<PermutationAxis> axis = parseAxis(line);
        if (!axis)
            return errorAt(name, lineNumber,
                           "permute: expected // permute NAME = VALUE VALUE ..., found " +
                               std::string(line));
        if (std::ranges::find(axes, axis->name, &PermutationAxis::name) != axes.end())
            return errorAt(name, lineNumber,
                           "permute: expected each name once, found " + axis->name + " again");
        axes.push_back(std::move(*axis));
    }
    return axes;
}

std::vector<std::vector<ShaderDefine>> expandPermutations(std::span<const PermutationAxis> axes) {
    std::vector<std::vector<ShaderDefine>> combinations(1);
    for (const PermutationAxis& axis : axes) {
        std::vector<std::vector<ShaderDefine>> longer;
        for (const std::vector<ShaderDefine>& combination : combinations) {
            for (const std::string& value : axis.values) {
                longer.push_back(combination);
                longer.back().push_back({axis.name, value});
            }
        }
        combinations = std::move(longer);
    }
    return combinations;
}

std::string assemble(const ShaderText& shader, std::span<const ShaderDefine> defines) {
    std::string text = "#version 450 core\n";
    for (const ShaderDefine& define : defines)
        text += "#define " + define.name + " " + define.value + "\n";
    return text + shader.text;
}

std::string describePlace(std::size_t source, std::size_t line,
                          std::span<const std::string> files) {
    const std::size_t file = line < kLinesPerSource ? source : line / kLinesPerSource;
    if (file >= files.size())
        return {};
    return files[file] + ":" + std::to_string(line % kLinesPerSource);
}

std::string translateLog(std::string_view log, std::span<const std::string> files) {
    std::string translated;
    while (!log.empty()) {
        const bool endsWithLineFeed = log.find('\n') != std::string_view::npos;
        translated += translateLine(takeLine(log), files);
        if (endsWithLineFeed)
            translated.push_back('\n');
    }
    return translated;
}

} // namespace lamina::gl
