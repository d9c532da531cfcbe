#pragma once

#include "request.hpp"

namespace lamina::tool {

/// Checks every file that will be written, before work starts: known extensions, formats that fit a
/// grid given by --bounds, no file twice, none that is the mesh, and a place that can be written (a
/// temporary file is made there and removed).
/// Throws Failure: BadCommandLine, Unsupported, Failed.
void checkOutputs(const Request& request);

} // namespace lamina::tool
