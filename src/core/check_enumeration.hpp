#pragma once

#include <lamina/core/result.hpp>

#include <string>
#include <string_view>

namespace lamina {

/// Is the value one of its enumeration, which ends with `last`? Errors: InvalidArgument.
template<class Enumeration>
[[nodiscard]] Result<void> checkEnumeration(std::string_view operation, std::string_view what,
                                            Enumeration value, Enumeration last) {
    if (value <= last)
        return {};
    return Error{ErrorCode::InvalidArgument, std::string(operation) + ": expected a value of " +
                                                 std::string(what) + ", found " +
                                                 std::to_string(static_cast<int>(value))};
}

} // namespace lamina
