#pragma once

namespace lamina::tool {

/// Prints which GL contexts this machine offers and why others fail. Throws Failure if none works.
void listContexts();

} // namespace lamina::tool
