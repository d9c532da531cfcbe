#pragma once

#include <string>

namespace lamina::headless {

/// A shared library that is loaded at run time and stays loaded: graphics drivers leave threads and
/// exit handlers behind, which would run into unmapped code.
class DynamicLibrary {
public:
    explicit DynamicLibrary(const std::string& fileName);

    explicit operator bool() const { return mHandle != nullptr; }
    /// Why it did not load, in the loader's words.
    [[nodiscard]] const std::string& error() const { return mError; }

    /// Sets `function` to the symbol's address; false if there is none.
    template<class Function>
    [[nodiscard]] bool load(const char* symbol, Function*& function) const {
        function = reinterpret_cast<Function*>(find(symbol));
        return function != nullptr;
    }

private:
    [[nodiscard]] void* find(const char* symbol) const;

    void* mHandle;
    std::string mError;
};

} // namespace lamina::headless
