#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace lamina::tool {

/// The library's advice in the words of the command line: "Backend::Automatic" becomes "--backend
/// auto".
[[nodiscard]] inline std::string inOptionWords(std::string text) {
    using namespace std::string_view_literals;
    constexpr std::array kWords{
        std::pair{"SolidRule::Parity"sv, "--solid-rule parity"sv},
        std::pair{"SolidRule::Voted"sv, "--solid-rule voted"sv},
        std::pair{"SolidRule::FloodFill"sv, "--solid-rule flood"sv},
        std::pair{"Backend::Automatic"sv, "--backend auto"sv},
        std::pair{"Backend::Slicemap"sv, "--backend slicemap"sv},
        std::pair{"Coverage::Conservative"sv, "--coverage conservative"sv},
        std::pair{"Coverage::Solid"sv, "--coverage solid"sv},
    };
    for (const auto& [name, option] : kWords)
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at))
            text.replace(at, name.size(), option);
    return text;
}

} // namespace lamina::tool
