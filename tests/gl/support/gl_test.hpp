#pragma once

#include "gl/device_state.hpp"

#include <lamina/gl/device.hpp>
#include <lamina/headless/context.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lamina::test {

/// The context of this run, of the kind that --context names; made once by main() and kept current.
[[nodiscard]] headless::Context& context();

/// A host that uses Lamina: a current debug context with the host's own debug callback. A GL error
/// or a high-severity debug message fails the test during which it appears.
class GlTest : public testing::Test {
public:
    /// Messages of severity high since the last call.
    static std::vector<std::string> takeHighSeverityMessages();

protected:
    void SetUp() override;
    void TearDown() override;

    [[nodiscard]] Device& device() { return *mDevice; }
    /// The host's GL functions.
    [[nodiscard]] const GladGLContext& gl() { return device().state()->gl; }

    /// A linked program from GLSL of the host, for queries and state tests. Fails the test on
    /// errors.
    [[nodiscard]] GLuint buildProgram(std::vector<std::pair<GLenum, std::string>> stages);

    /// A buffer of the host's that holds `bytes`; deleted when the test ends.
    [[nodiscard]] GLuint hostBuffer(std::span<const std::byte> bytes);

    /// Fails the test if a call changes any GL state (gl_state.hpp) or leaves a GL error; `what`
    /// names the call.
    void expectUnchanged(const char* what, const std::function<void()>& call);

    /// Runs a compute shader with `invocations` work items (local_size_x = 64) that reads
    /// `input` at storage binding 0 and writes `output` at binding 1, and reads `output` back.
    void runCompute(GLuint program, std::span<const std::byte> input, std::span<std::byte> output,
                    std::uint32_t invocations);

private:
    std::optional<Device> mDevice;
    std::vector<GLuint> mHostBuffers;
};

} // namespace lamina::test
