#pragma once

#include <lamina/headless/context.hpp>

#include <memory>
#include <string>
#include <vector>

namespace lamina::headless {

/// A context of one API. A derived destructor destroys the context, which is not current then.
class NativeContext {
public:
    NativeContext(ContextApi api, std::string kind)
        : api(api)
        , kind(std::move(kind)) {}
    virtual ~NativeContext() = default;
    NativeContext(const NativeContext&) = delete;
    NativeContext& operator=(const NativeContext&) = delete;

    /// Makes the context current; returns why not, or nothing.
    [[nodiscard]] virtual std::string bind() = 0;
    virtual void release() = 0;
    [[nodiscard]] virtual bool isCurrent() const = 0;
    [[nodiscard]] virtual GlLoader loader() const = 0;

    const ContextApi api;
    const std::string kind;
};

/// What failed so far, one "way: reason" each.
using Attempts = std::vector<std::string>;

/// The first context that serves `desc`, current on the calling thread, or null with a reason for
/// each failure in `attempts`. The caller has released whatever of ours was current.
std::unique_ptr<NativeContext> createEgl(const ContextDesc& desc, Attempts& attempts);
std::unique_ptr<NativeContext> createOsMesa(const ContextDesc& desc, Attempts& attempts);

/// Why the current context `native` is not the one that `desc` asks for; empty if it is.
std::string checkVersion(const NativeContext& native, const ContextDesc& desc);

} // namespace lamina::headless
