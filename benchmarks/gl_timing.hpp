#pragma once

#include <lamina/core/result.hpp>
#include <lamina/gl/device.hpp>

#include <benchmark/benchmark.h>

#include <functional>

namespace lamina::bench {

/// Times `work`, which issues GL commands: twice to warm programs and drivers, then once an
/// iteration, waiting for the GL after each. Adds "GPU ms" where the GL has a timer that works.
[[nodiscard]] Result<void> measure(benchmark::State& state, const Device& device,
                                   const std::function<Result<void>()>& work);

} // namespace lamina::bench
