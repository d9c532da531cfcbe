#pragma once

#include <lamina/core/result.hpp>

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace example {

/// What an example does with an error: says it and ends. An engine has its own way.
inline void check(const lamina::Result<void>& result) {
    if (result)
        return;
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
    std::exit(1);
}

/// The value of `result`, or the end as above.
template<class T>
T check(lamina::Result<T> result) {
    if (!result)
        check(lamina::Result<void>(result.error()));
    return std::move(*result);
}

} // namespace example
