#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>

#include <string>

namespace lamina::tool {

/// Shows options as "name VALUES" with descriptions broken into lines of a terminal's width; what
/// excludes what is said once, in the footer.
class HelpFormatter : public CLI::Formatter {
public:
    HelpFormatter();

    std::string make_group(std::string group, bool isPositional,
                           std::vector<const CLI::Option*> options) const override;
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_option_desc(const CLI::Option* option) const override;
    std::string make_usage(const CLI::App* app, std::string name) const override;
};

/// The lines above and below the options.
extern const char* const kHelpDescription;
extern const char* const kHelpFooter;

} // namespace lamina::tool
