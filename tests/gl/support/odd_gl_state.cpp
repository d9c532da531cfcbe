#include "gl/support/gl_state.hpp"

namespace lamina::test {

GLuint OddGlState::buffer() {
    GLuint id = 0;
    mGl.CreateBuffers(1, &id);
    mGl.NamedBufferData(id, 4096, nullptr, GL_STATIC_DRAW);
    mBuffers.push_back(id);
    return id;
}

GLuint OddGlState::texture(GLenum target) {
    GLuint id = 0;
    mGl.CreateTextures(target, 1, &id);
    mTextures.push_back(id);
    return id;
}

void OddGlState::setCapabilities(bool odd) {
    for (const GLenum capability : {GL_COLOR_LOGIC_OP,
                                    GL_CULL_FACE,
                                    GL_DEPTH_CLAMP,
                                    GL_DEPTH_TEST,
                                    GL_FRAMEBUFFER_SRGB,
                                    GL_LINE_SMOOTH,
                                    GL_POLYGON_OFFSET_FILL,
                                    GL_POLYGON_SMOOTH,
                                    GL_PRIMITIVE_RESTART,
                                    GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                    GL_RASTERIZER_DISCARD,
                                    GL_SAMPLE_ALPHA_TO_COVERAGE,
                                    GL_SAMPLE_COVERAGE,
                                    GL_SAMPLE_SHADING,
                                    GL_SAMPLE_MASK,
                                    GL_STENCIL_TEST,
                                    GL_TEXTURE_CUBE_MAP_SEAMLESS,
                                    GL_PROGRAM_POINT_SIZE,
                                    GL_CLIP_DISTANCE0,
                                    GL_CLIP_DISTANCE3,
                                    GL_CLIP_DISTANCE7}) {
        if (odd)
            mGl.Enable(capability);
        else
            mGl.Disable(capability);
    }
    for (const GLenum capability : {GL_DITHER, GL_MULTISAMPLE}) {
        if (odd)
            mGl.Disable(capability);
        else
            mGl.Enable(capability);
    }
}

OddGlState::OddGlState(const GladGLContext& gl)
    : mGl(gl) {
    setCapabilities(true);
    for (GLuint i = 0; i < kDrawBuffers; ++i) {
        const bool odd = i % 2 == 1;
        if (odd)
            gl.Enablei(GL_BLEND, i);
        gl.ColorMaski(i, odd, GL_FALSE, !odd, GL_FALSE);
        gl.BlendFuncSeparatei(i, GL_DST_COLOR, GL_ONE, GL_SRC_ALPHA, GL_ZERO);
        gl.BlendEquationSeparatei(i, GL_FUNC_SUBTRACT, GL_MIN);
    }
    for (GLuint i = 0; i < kViewports; ++i) {
        const auto f = static_cast<float>(i);
        gl.ViewportIndexedf(i, f + 0.25f, f - 3.5f, 7.0f + f, 5.0f + f);
        gl.ScissorIndexed(i, 1, 2, 3 + static_cast<int>(i), 4);
        gl.DepthRangeIndexed(i, 0.75, 0.25);
        if (i % 3 == 0)
            gl.Enablei(GL_SCISSOR_TEST, i);
    }
    gl.BlendColor(0.1f, 0.2f, 0.3f, 0.4f);
    gl.ClearColor(0.5f, 0.6f, 0.7f, 0.8f);
    gl.ClearDepth(0.3);
    gl.ClearStencil(5);
    gl.CullFace(GL_FRONT_AND_BACK);
    gl.FrontFace(GL_CW);
    gl.DepthFunc(GL_NEVER);
    gl.DepthMask(GL_FALSE);
    gl.LogicOp(GL_NAND);
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    gl.PolygonOffset(3.0f, 4.0f);
    gl.PrimitiveRestartIndex(2);
    gl.ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    gl.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    gl.SampleCoverage(0.25f, GL_TRUE);
    gl.SampleMaski(0, 0x5u);
    gl.MinSampleShading(0.5f);
    gl.StencilFuncSeparate(GL_FRONT, GL_NEVER, 3, 0x0fu);
    gl.StencilFuncSeparate(GL_BACK, GL_GREATER, 4, 0xf0u);
    gl.StencilOpSeparate(GL_FRONT, GL_INCR, GL_DECR, GL_INVERT);
    gl.StencilMaskSeparate(GL_BACK, 0x3cu);
    gl.PointSize(3.0f);
    gl.PatchParameteri(GL_PATCH_VERTICES, 5);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 8);
    gl.PixelStorei(GL_PACK_ROW_LENGTH, 77);
    gl.PixelStorei(GL_PACK_IMAGE_HEIGHT, 55);
    gl.PixelStorei(GL_PACK_SKIP_PIXELS, 3);
    gl.PixelStorei(GL_PACK_SKIP_ROWS, 2);
    gl.PixelStorei(GL_PACK_SKIP_IMAGES, 1);
    gl.PixelStorei(GL_PACK_SWAP_BYTES, 1);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 2);
    gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 66);
    gl.PixelStorei(GL_UNPACK_IMAGE_HEIGHT, 44);
    gl.PixelStorei(GL_UNPACK_SKIP_PIXELS, 4);
    gl.PixelStorei(GL_UNPACK_SKIP_ROWS, 3);
    gl.PixelStorei(GL_UNPACK_SKIP_IMAGES, 1);
    gl.PixelStorei(GL_UNPACK_SWAP_BYTES, 1);

    for (const GLenum target :
         {GL_ARRAY_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, GL_DISPATCH_INDIRECT_BUFFER,
          GL_DRAW_INDIRECT_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER, GL_QUERY_BUFFER,
          GL_TEXTURE_BUFFER})
        gl.BindBuffer(target, buffer());
    for (GLuint i = 0; i < kUniformBuffers; ++i) {
        if (i % 2 == 0)
            gl.BindBufferRange(GL_UNIFORM_BUFFER, i, buffer(), 256, 512);
        else
            gl.BindBufferBase(GL_UNIFORM_BUFFER, i, buffer());
    }
    gl.BindBuffer(GL_UNIFORM_BUFFER, buffer());
    for (GLuint i = 0; i < kStorageBuffers; ++i)
        gl.BindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffer(), 256, 1024);
    gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer());

    for (GLuint i = 0; i < kTextureUnits; ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        for (const GLenum target :
             {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_3D, GL_TEXTURE_BUFFER,
              GL_TEXTURE_CUBE_MAP, GL_TEXTURE_RECTANGLE})
            gl.BindTexture(target, texture(target));
        GLuint sampler = 0;
        gl.CreateSamplers(1, &sampler);
        gl.BindSampler(i, sampler);
        mSamplers.push_back(sampler);
    }
    gl.ActiveTexture(GL_TEXTURE7);
    const GLuint image = texture(GL_TEXTURE_2D);
    gl.TextureStorage2D(image, 2, GL_R32UI, 8, 8);
    for (GLuint i = 0; i < kImageUnits; ++i)
        gl.BindImageTexture(i, image, 1, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);

    GLuint name = 0;
    gl.CreateTransformFeedbacks(1, &name);
    gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, name);
    mFeedbacks.push_back(name);
    for (GLuint i = 0; i < kFeedbackBuffers; ++i)
        gl.BindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, i, buffer(), 128, 512);
    const GLuint color = texture(GL_TEXTURE_2D);
    gl.TextureStorage2D(color, 1, GL_RGBA8, 16, 16);
    for (const GLenum target : {GL_DRAW_FRAMEBUFFER, GL_READ_FRAMEBUFFER}) {
        gl.CreateFramebuffers(1, &name);
        gl.NamedFramebufferTexture(name, GL_COLOR_ATTACHMENT1, color, 0);
        gl.NamedFramebufferDrawBuffer(name, GL_COLOR_ATTACHMENT1);
        gl.NamedFramebufferReadBuffer(name, GL_COLOR_ATTACHMENT1);
        gl.BindFramebuffer(target, name);
        mFramebuffers.push_back(name);
    }
    gl.CreateRenderbuffers(1, &name);
    gl.BindRenderbuffer(GL_RENDERBUFFER, name);
    mRenderbuffers.push_back(name);
    gl.CreateVertexArrays(1, &name);
    gl.EnableVertexArrayAttrib(name, 3);
    gl.VertexArrayVertexBuffer(name, 3, buffer(), 4, 20);
    gl.VertexArrayElementBuffer(name, buffer());
    gl.BindVertexArray(name);
    mVertexArrays.push_back(name);
    gl.CreateProgramPipelines(1, &name);
    gl.BindProgramPipeline(name);
    mPipelines.push_back(name);
    const char* source = "#version 450\nvoid main() { gl_Position = vec4(0.0); }";
    const GLuint shader = gl.CreateShader(GL_VERTEX_SHADER);
    gl.ShaderSource(shader, 1, &source, nullptr);
    gl.CompileShader(shader);
    name = gl.CreateProgram();
    gl.AttachShader(name, shader);
    gl.LinkProgram(name);
    gl.DeleteShader(shader);
    gl.UseProgram(name);
    mPrograms.push_back(name);
    gl.PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 1, -1, "odd state");
}

OddGlState::~OddGlState() {
    const GladGLContext& gl = mGl;
    gl.PopDebugGroup();
    setCapabilities(false);
    for (GLuint i = 0; i < kDrawBuffers; ++i) {
        gl.Disablei(GL_BLEND, i);
        gl.ColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    for (GLuint i = 0; i < kViewports; ++i) {
        gl.Disablei(GL_SCISSOR_TEST, i);
        gl.DepthRangeIndexed(i, 0.0, 1.0);
    }
    gl.CullFace(GL_BACK);
    gl.FrontFace(GL_CCW);
    gl.DepthFunc(GL_LESS);
    gl.DepthMask(GL_TRUE);
    gl.LogicOp(GL_COPY);
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    for (const GLenum name :
         {GL_PACK_ROW_LENGTH, GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS,
          GL_PACK_SKIP_IMAGES, GL_PACK_SWAP_BYTES, GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT,
          GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES})
        gl.PixelStorei(name, 0);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl.UseProgram(0);
    gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
    gl.BindProgramPipeline(0);
    gl.BindVertexArray(0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl.BindRenderbuffer(GL_RENDERBUFFER, 0);
    gl.ActiveTexture(GL_TEXTURE0);
    // Deleting an object unbinds it from the current context.
    const auto count = [](const std::vector<GLuint>& names) {
        return static_cast<GLsizei>(names.size());
    };
    gl.DeleteBuffers(count(mBuffers), mBuffers.data());
    gl.DeleteTextures(count(mTextures), mTextures.data());
    gl.DeleteSamplers(count(mSamplers), mSamplers.data());
    gl.DeleteFramebuffers(count(mFramebuffers), mFramebuffers.data());
    gl.DeleteRenderbuffers(count(mRenderbuffers), mRenderbuffers.data());
    gl.DeleteVertexArrays(count(mVertexArrays), mVertexArrays.data());
    gl.DeleteTransformFeedbacks(count(mFeedbacks), mFeedbacks.data());
    gl.DeleteProgramPipelines(count(mPipelines), mPipelines.data());
    for (const GLuint program : mPrograms)
        gl.DeleteProgram(program);
}

} // namespace lamina::test
