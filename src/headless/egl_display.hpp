#pragma once

#include "headless/egl_functions.hpp"
#include "headless/native_context.hpp"

#include <functional>
#include <string>
#include <vector>

namespace lamina::headless {

/// A way to a display that may work.
struct DisplayCandidate {
    std::string kind; ///< "EGL device 0 (software)"
    std::function<EGLDisplay()> open;
    bool needsPbuffer = false;
};

/// The ways that `desc` allows, the most promising first. Reasons why a whole platform is out of
/// the question go to `attempts`. `egl` must outlive the result.
std::vector<DisplayCandidate> listDisplays(const Egl& egl, const ContextDesc& desc,
                                           Attempts& attempts);

} // namespace lamina::headless
