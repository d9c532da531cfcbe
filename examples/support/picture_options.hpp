#pragma once

#include <CLI/CLI.hpp>

namespace example {

/// Adds --width and --height, and --columns of the sprites, to what a program understands; its
/// settings have members of these names.
template<class Settings>
void addPictureOptions(CLI::App& app, Settings& settings) {
    app.add_option("--columns", settings.columns, "Columns of the sprites")
        ->check(CLI::Range(4, 8192))
        ->capture_default_str();
    app.add_option("--width", settings.width, "Pixels")
        ->check(CLI::Range(16, 4096))
        ->capture_default_str();
    app.add_option("--height", settings.height, "Pixels")
        ->check(CLI::Range(16, 4096))
        ->capture_default_str();
}

} // namespace example
