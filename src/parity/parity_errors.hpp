#pragma once

#include <lamina/core/result.hpp>

#include <string>
#include <string_view>

namespace lamina::detail {

/// An error of a part that serves several modules, in this operation's words: its name in place of
/// the part's, and its advice in place of "use fewer voxels".
[[nodiscard]] inline Error inWordsOf(std::string_view operation, std::string_view advice,
                                     Error error) {
    for (const std::string_view part : {"voxelize: ", "lamina slicemap: "})
        if (error.text.starts_with(part))
            error.text.replace(0, part.size() - 2, operation);
    constexpr std::string_view kVoxels = "use fewer voxels";
    if (error.text.ends_with(kVoxels))
        error.text.replace(error.text.size() - kVoxels.size(), kVoxels.size(), advice);
    return error;
}

} // namespace lamina::detail
