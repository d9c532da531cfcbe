#pragma once

#include <functional>

namespace lamina {

/// Told how far a long operation is: a fraction in [0,1] that never falls. Called on the thread
/// that started the operation, at most a few hundred times. Empty: nobody is told.
using ProgressCallback = std::function<void(double fraction)>;

} // namespace lamina
