#pragma once

#include "run_record.hpp"

#include <string>

namespace lamina::tool {

/// The record as one JSON object; --stats. UTF-8, ends in a newline.
[[nodiscard]] std::string statsJson(const RunRecord& record);

/// A few lines for people about what was made.
[[nodiscard]] std::string summary(const RunRecord& record);

/// What --info prints.
[[nodiscard]] std::string meshDescription(const RunRecord& record);

/// What --compare prints.
[[nodiscard]] std::string comparisonTable(const RunRecord& record);

} // namespace lamina::tool
