#pragma once

#include <functional>

namespace lamina {

/// Told how far a long operation is, a fraction in [0,1] that never falls, and asked whether to go
/// on: false ends the operation with ErrorCode::Cancelled, and it leaves nothing behind. Called on
/// the thread that started the operation, at most a few hundred times. Empty: nobody is told.
using ProgressCallback = std::function<bool(double fraction)>;

} // namespace lamina
