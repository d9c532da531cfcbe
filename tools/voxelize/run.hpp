#pragma once

#include "request.hpp"

namespace lamina::tool {

/// Does what the command line asks for. Throws Failure.
void run(const Request& request);

} // namespace lamina::tool
