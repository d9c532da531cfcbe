#pragma once

#include "failure.hpp"

#include <lamina/grid/grid_transform.hpp>
#include <lamina/headless/context.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>

/// The words that options take.
namespace lamina::tool {

template<class T>
struct Choice {
    std::string_view word;
    T value;
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

/// "a, b, c".
template<class Table>
[[nodiscard]] std::string words(const Table& table) {
    std::string list;
    for (const auto& choice : table)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", choice.word);
    return list;
}

/// The value of `word`, given for `option`.
/// Throws Failure for an unknown word.
template<class Table>
[[nodiscard]] auto choose(std::string_view option, const Table& table, std::string_view word) {
    for (const auto& choice : table)
        if (choice.word == word)
            return choice.value;
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
