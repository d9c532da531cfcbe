#pragma once

#include "failure.hpp"

#include <lamina/grid/grid_transform.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>

/// The words that options take. A word without a value is known but not served by this version:
/// serving it is a matter of naming its value here.
namespace lamina::tool {

template<class T>
struct Choice {
    std::string_view word;
    std::optional<T> value = std::nullopt;
};

inline constexpr std::array kCoverages{
    Choice<Coverage>{"sampled", Coverage::Sampled},
    Choice<Coverage>{"filled", Coverage::Filled},
    Choice<Coverage>{"conservative", Coverage::Conservative},
    Choice<Coverage>{"separating6", Coverage::Separating6},
    Choice<Coverage>{"solid", Coverage::Solid},
};

inline constexpr std::array kSolidRules{
    Choice<SolidRule>{"parity", SolidRule::Parity},
    Choice<SolidRule>{"voted", SolidRule::Voted},
    Choice<SolidRule>{"flood", SolidRule::FloodFill},
};

inline constexpr std::array kBackends{
    Choice<Backend>{"auto", Backend::Automatic},
    Choice<Backend>{"slicemap", Backend::Slicemap},
    Choice<Backend>{"local_slicemap", Backend::LocalSlicemap},
    Choice<Backend>{"mrt_slicemap", Backend::MrtSlicemap},
    Choice<Backend>{"volume", Backend::Volume},
    Choice<Backend>{"overlap", Backend::Overlap},
};

inline constexpr std::array kContexts{
    Choice<headless::ContextApi>{"auto", headless::ContextApi::Automatic},
    Choice<headless::ContextApi>{"egl", headless::ContextApi::Egl},
    Choice<headless::ContextApi>{"osmesa", headless::ContextApi::OsMesa},
};

inline constexpr std::array kAxes{
    Choice<Axis>{"x", Axis::X},
    Choice<Axis>{"y", Axis::Y},
    Choice<Axis>{"z", Axis::Z},
};

/// "a, b, c"; `servedOnly`: without the words that have no value.
template<class Table>
[[nodiscard]] std::string words(const Table& table, bool servedOnly = false) {
    std::string list;
    for (const auto& choice : table)
        if (choice.value || !servedOnly)
            list += fmt::format("{}{}", list.empty() ? "" : ", ", choice.word);
    return list;
}

/// The value of `word`, given for `option`.
/// Throws Failure: BadCommandLine for an unknown word, Unsupported for one without value.
template<class Table>
[[nodiscard]] auto choose(std::string_view option, const Table& table, std::string_view word) {
    for (const auto& choice : table) {
        if (choice.word != word)
            continue;
        if (!choice.value)
            throw Failure(ExitCode::Unsupported,
                          fmt::format("{}: {} is not served by this version; choose one of {}",
                                      option, word, words(table, true)));
        return *choice.value;
    }
    throw Failure(ExitCode::BadCommandLine,
                  fmt::format("{}: expected one of {}, found '{}'", option, words(table), word));
}

/// The word for a value of the table.
template<class Table, class T>
[[nodiscard]] std::string_view wordOf(const Table& table, T value) {
    for (const auto& choice : table)
        if (choice.value == value)
            return choice.word;
    return "unknown";
}

} // namespace lamina::tool
