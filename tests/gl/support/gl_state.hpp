#pragma once

#include "gl/glad.hpp"

#include <map>
#include <string>
#include <vector>

namespace lamina::test {

/// GL state by name: "GL_VIEWPORT[0]" -> its values.
using GlState = std::map<std::string, std::vector<double>>;

/// How much of indexed state is read, and made odd.
inline constexpr GLuint kDrawBuffers = 8, kViewports = 16, kTextureUnits = 16, kImageUnits = 8,
                        kUniformBuffers = 24, kStorageBuffers = 8, kFeedbackBuffers = 4;

/// Reads all context state that rasterization, compute, transfers and queries of an engine depend
/// on; changes none of it.
[[nodiscard]] GlState readGlState(const GladGLContext& gl);

/// "name: before -> after", a line for each difference.
[[nodiscard]] std::vector<std::string> differences(const GlState& before, const GlState& after);

/// A context state far from the defaults in every part that readGlState() reads, as a careless
/// engine may leave it, with objects of its own bound everywhere. Puts the defaults back when
/// destroyed.
class OddGlState {
public:
    explicit OddGlState(const GladGLContext& gl);
    ~OddGlState();
    OddGlState(const OddGlState&) = delete;
    OddGlState& operator=(const OddGlState&) = delete;

private:
    GLuint buffer();
    GLuint texture(GLenum target);
    void setCapabilities(bool odd);

    const GladGLContext& mGl;
    std::vector<GLuint> mBuffers, mTextures, mFramebuffers, mVertexArrays, mSamplers, mPrograms,
        mRenderbuffers, mPipelines, mFeedbacks;
};

} // namespace lamina::test
