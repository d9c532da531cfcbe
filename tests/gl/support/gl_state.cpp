#include "gl/support/gl_state.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace lamina::test {
namespace {

struct Named {
    GLenum value;
    const char* name;
    int count = 1;
};
#define NAMED(value)                                                                               \
    Named {                                                                                        \
        value, #value                                                                              \
    }
#define NAMED_N(value, count)                                                                      \
    Named {                                                                                        \
        value, #value, count                                                                       \
    }

constexpr Named kCapabilities[] = {
    NAMED(GL_COLOR_LOGIC_OP),
    NAMED(GL_CULL_FACE),
    NAMED(GL_DEBUG_OUTPUT),
    NAMED(GL_DEBUG_OUTPUT_SYNCHRONOUS),
    NAMED(GL_DEPTH_CLAMP),
    NAMED(GL_DEPTH_TEST),
    NAMED(GL_DITHER),
    NAMED(GL_FRAMEBUFFER_SRGB),
    NAMED(GL_LINE_SMOOTH),
    NAMED(GL_MULTISAMPLE),
    NAMED(GL_POLYGON_OFFSET_FILL),
    NAMED(GL_POLYGON_OFFSET_LINE),
    NAMED(GL_POLYGON_OFFSET_POINT),
    NAMED(GL_POLYGON_SMOOTH),
    NAMED(GL_PRIMITIVE_RESTART),
    NAMED(GL_PRIMITIVE_RESTART_FIXED_INDEX),
    NAMED(GL_RASTERIZER_DISCARD),
    NAMED(GL_SAMPLE_ALPHA_TO_COVERAGE),
    NAMED(GL_SAMPLE_ALPHA_TO_ONE),
    NAMED(GL_SAMPLE_COVERAGE),
    NAMED(GL_SAMPLE_SHADING),
    NAMED(GL_SAMPLE_MASK),
    NAMED(GL_STENCIL_TEST),
    NAMED(GL_TEXTURE_CUBE_MAP_SEAMLESS),
    NAMED(GL_PROGRAM_POINT_SIZE),
    NAMED(GL_CLIP_DISTANCE0),
    NAMED(GL_CLIP_DISTANCE1),
    NAMED(GL_CLIP_DISTANCE2),
    NAMED(GL_CLIP_DISTANCE3),
    NAMED(GL_CLIP_DISTANCE4),
    NAMED(GL_CLIP_DISTANCE5),
    NAMED(GL_CLIP_DISTANCE6),
    NAMED(GL_CLIP_DISTANCE7),
};

constexpr Named kValues[] = {
    NAMED(GL_ACTIVE_TEXTURE),
    NAMED(GL_ARRAY_BUFFER_BINDING),
    NAMED_N(GL_BLEND_COLOR, 4),
    NAMED_N(GL_COLOR_CLEAR_VALUE, 4),
    NAMED(GL_COPY_READ_BUFFER_BINDING),
    NAMED(GL_COPY_WRITE_BUFFER_BINDING),
    NAMED(GL_CULL_FACE_MODE),
    NAMED(GL_CURRENT_PROGRAM),
    NAMED(GL_DEPTH_CLEAR_VALUE),
    NAMED(GL_DEPTH_FUNC),
    NAMED(GL_DEPTH_WRITEMASK),
    NAMED(GL_DISPATCH_INDIRECT_BUFFER_BINDING),
    NAMED(GL_DRAW_INDIRECT_BUFFER_BINDING),
    NAMED(GL_DRAW_FRAMEBUFFER_BINDING),
    NAMED(GL_READ_FRAMEBUFFER_BINDING),
    NAMED(GL_ELEMENT_ARRAY_BUFFER_BINDING),
    NAMED(GL_FRONT_FACE),
    NAMED(GL_FRAGMENT_SHADER_DERIVATIVE_HINT),
    NAMED(GL_LINE_SMOOTH_HINT),
    NAMED(GL_POLYGON_SMOOTH_HINT),
    NAMED(GL_TEXTURE_COMPRESSION_HINT),
    NAMED(GL_LINE_WIDTH),
    NAMED(GL_LOGIC_OP_MODE),
    NAMED(GL_MIN_SAMPLE_SHADING_VALUE),
    NAMED(GL_PACK_ALIGNMENT),
    NAMED(GL_PACK_IMAGE_HEIGHT),
    NAMED(GL_PACK_LSB_FIRST),
    NAMED(GL_PACK_ROW_LENGTH),
    NAMED(GL_PACK_SKIP_IMAGES),
    NAMED(GL_PACK_SKIP_PIXELS),
    NAMED(GL_PACK_SKIP_ROWS),
    NAMED(GL_PACK_SWAP_BYTES),
    NAMED(GL_UNPACK_ALIGNMENT),
    NAMED(GL_UNPACK_IMAGE_HEIGHT),
    NAMED(GL_UNPACK_LSB_FIRST),
    NAMED(GL_UNPACK_ROW_LENGTH),
    NAMED(GL_UNPACK_SKIP_IMAGES),
    NAMED(GL_UNPACK_SKIP_PIXELS),
    NAMED(GL_UNPACK_SKIP_ROWS),
    NAMED(GL_UNPACK_SWAP_BYTES),
    NAMED(GL_PATCH_VERTICES),
    NAMED_N(GL_PATCH_DEFAULT_INNER_LEVEL, 2),
    NAMED_N(GL_PATCH_DEFAULT_OUTER_LEVEL, 4),
    NAMED(GL_PIXEL_PACK_BUFFER_BINDING),
    NAMED(GL_PIXEL_UNPACK_BUFFER_BINDING),
    NAMED(GL_POINT_FADE_THRESHOLD_SIZE),
    NAMED(GL_POINT_SIZE),
    NAMED(GL_POINT_SPRITE_COORD_ORIGIN),
    NAMED_N(GL_POLYGON_MODE, 2),
    NAMED(GL_POLYGON_OFFSET_FACTOR),
    NAMED(GL_POLYGON_OFFSET_UNITS),
    NAMED(GL_PRIMITIVE_RESTART_INDEX),
    NAMED(GL_PROGRAM_PIPELINE_BINDING),
    NAMED(GL_PROVOKING_VERTEX),
    NAMED(GL_QUERY_BUFFER_BINDING),
    NAMED(GL_RENDERBUFFER_BINDING),
    NAMED(GL_SAMPLE_COVERAGE_INVERT),
    NAMED(GL_SAMPLE_COVERAGE_VALUE),
    NAMED(GL_SHADER_STORAGE_BUFFER_BINDING),
    NAMED(GL_STENCIL_FUNC),
    NAMED(GL_STENCIL_REF),
    NAMED(GL_STENCIL_VALUE_MASK),
    NAMED(GL_STENCIL_WRITEMASK),
    NAMED(GL_STENCIL_FAIL),
    NAMED(GL_STENCIL_PASS_DEPTH_FAIL),
    NAMED(GL_STENCIL_PASS_DEPTH_PASS),
    NAMED(GL_STENCIL_BACK_FUNC),
    NAMED(GL_STENCIL_BACK_REF),
    NAMED(GL_STENCIL_BACK_VALUE_MASK),
    NAMED(GL_STENCIL_BACK_WRITEMASK),
    NAMED(GL_STENCIL_BACK_FAIL),
    NAMED(GL_STENCIL_BACK_PASS_DEPTH_FAIL),
    NAMED(GL_STENCIL_BACK_PASS_DEPTH_PASS),
    NAMED(GL_STENCIL_CLEAR_VALUE),
    NAMED(GL_TEXTURE_BUFFER_BINDING),
    NAMED(GL_TRANSFORM_FEEDBACK_BINDING),
    NAMED(GL_TRANSFORM_FEEDBACK_ACTIVE),
    NAMED(GL_TRANSFORM_FEEDBACK_PAUSED),
    NAMED(GL_UNIFORM_BUFFER_BINDING),
    NAMED(GL_ATOMIC_COUNTER_BUFFER_BINDING),
    NAMED(GL_VERTEX_ARRAY_BINDING),
    NAMED(GL_CLIP_ORIGIN),
    NAMED(GL_CLIP_DEPTH_MODE),
    NAMED(GL_DEBUG_GROUP_STACK_DEPTH),
    NAMED(GL_READ_BUFFER),
};

constexpr Named kDrawBufferValues[] = {
    NAMED_N(GL_COLOR_WRITEMASK, 4), NAMED(GL_BLEND_SRC_RGB),   NAMED(GL_BLEND_SRC_ALPHA),
    NAMED(GL_BLEND_DST_RGB),        NAMED(GL_BLEND_DST_ALPHA), NAMED(GL_BLEND_EQUATION_RGB),
    NAMED(GL_BLEND_EQUATION_ALPHA),
};

constexpr Named kTextureBindings[] = {
    NAMED(GL_TEXTURE_BINDING_1D),
    NAMED(GL_TEXTURE_BINDING_1D_ARRAY),
    NAMED(GL_TEXTURE_BINDING_2D),
    NAMED(GL_TEXTURE_BINDING_2D_ARRAY),
    NAMED(GL_TEXTURE_BINDING_2D_MULTISAMPLE),
    NAMED(GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY),
    NAMED(GL_TEXTURE_BINDING_3D),
    NAMED(GL_TEXTURE_BINDING_BUFFER),
    NAMED(GL_TEXTURE_BINDING_CUBE_MAP),
    NAMED(GL_TEXTURE_BINDING_CUBE_MAP_ARRAY),
    NAMED(GL_TEXTURE_BINDING_RECTANGLE),
    NAMED(GL_SAMPLER_BINDING),
};

constexpr Named kImageValues[] = {
    NAMED(GL_IMAGE_BINDING_NAME),  NAMED(GL_IMAGE_BINDING_LEVEL),  NAMED(GL_IMAGE_BINDING_LAYERED),
    NAMED(GL_IMAGE_BINDING_LAYER), NAMED(GL_IMAGE_BINDING_ACCESS), NAMED(GL_IMAGE_BINDING_FORMAT),
};

struct IndexedBuffer {
    Named binding, start, size;
    GLuint count;
};
constexpr IndexedBuffer kIndexedBuffers[] = {
    {NAMED(GL_UNIFORM_BUFFER_BINDING), NAMED(GL_UNIFORM_BUFFER_START),
     NAMED(GL_UNIFORM_BUFFER_SIZE), kUniformBuffers},
    {NAMED(GL_SHADER_STORAGE_BUFFER_BINDING), NAMED(GL_SHADER_STORAGE_BUFFER_START),
     NAMED(GL_SHADER_STORAGE_BUFFER_SIZE), kStorageBuffers},
    {NAMED(GL_ATOMIC_COUNTER_BUFFER_BINDING), NAMED(GL_ATOMIC_COUNTER_BUFFER_START),
     NAMED(GL_ATOMIC_COUNTER_BUFFER_SIZE), 1},
    {NAMED(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING), NAMED(GL_TRANSFORM_FEEDBACK_BUFFER_START),
     NAMED(GL_TRANSFORM_FEEDBACK_BUFFER_SIZE), kFeedbackBuffers},
};

constexpr GLuint kAttributes = 8;

std::string indexed(const char* name, GLuint index) {
    return std::string(name) + "[" + std::to_string(index) + "]";
}

} // namespace

GlState readGlState(const GladGLContext& gl) {
    GlState state;
    for (const Named& capability : kCapabilities)
        state[capability.name] = {static_cast<double>(gl.IsEnabled(capability.value))};
    for (const Named& value : kValues) {
        std::array<GLdouble, 4> values{};
        gl.GetDoublev(value.value, values.data());
        state[value.name].assign(values.begin(), values.begin() + value.count);
    }
    for (GLuint i = 0; i < kDrawBuffers; ++i) {
        state[indexed("GL_BLEND", i)] = {static_cast<double>(gl.IsEnabledi(GL_BLEND, i))};
        for (const Named& value : kDrawBufferValues) {
            std::array<GLint, 4> values{};
            gl.GetIntegeri_v(value.value, i, values.data());
            state[indexed(value.name, i)].assign(values.begin(), values.begin() + value.count);
        }
        GLint drawBuffer = 0;
        gl.GetIntegerv(GL_DRAW_BUFFER0 + i, &drawBuffer);
        state[indexed("GL_DRAW_BUFFER", i)] = {static_cast<double>(drawBuffer)};
    }
    for (GLuint i = 0; i < kViewports; ++i) {
        std::array<GLfloat, 4> viewport{};
        gl.GetFloati_v(GL_VIEWPORT, i, viewport.data());
        state[indexed("GL_VIEWPORT", i)].assign(viewport.begin(), viewport.end());
        std::array<GLdouble, 2> depths{};
        gl.GetDoublei_v(GL_DEPTH_RANGE, i, depths.data());
        state[indexed("GL_DEPTH_RANGE", i)].assign(depths.begin(), depths.end());
        std::array<GLint, 4> box{};
        gl.GetIntegeri_v(GL_SCISSOR_BOX, i, box.data());
        state[indexed("GL_SCISSOR_BOX", i)].assign(box.begin(), box.end());
        state[indexed("GL_SCISSOR_TEST", i)] = {
            static_cast<double>(gl.IsEnabledi(GL_SCISSOR_TEST, i))};
    }
    for (const IndexedBuffer& buffers : kIndexedBuffers)
        for (GLuint i = 0; i < buffers.count; ++i) {
            GLint name = 0;
            GLint64 start = 0;
            GLint64 size = 0;
            gl.GetIntegeri_v(buffers.binding.value, i, &name);
            gl.GetInteger64i_v(buffers.start.value, i, &start);
            gl.GetInteger64i_v(buffers.size.value, i, &size);
            state[indexed(buffers.binding.name, i)] = {
                static_cast<double>(name), static_cast<double>(start), static_cast<double>(size)};
        }
    for (GLuint i = 0; i < kImageUnits; ++i)
        for (const Named& value : kImageValues) {
            GLint found = 0;
            gl.GetIntegeri_v(value.value, i, &found);
            state[indexed(value.name, i)] = {static_cast<double>(found)};
        }
    GLint sampleMask = 0;
    gl.GetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, &sampleMask);
    state["GL_SAMPLE_MASK_VALUE"] = {static_cast<double>(sampleMask)};
    GLint active = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (GLuint i = 0; i < kTextureUnits; ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        for (const Named& binding : kTextureBindings) {
            GLint name = 0;
            gl.GetIntegerv(binding.value, &name);
            state[indexed(binding.name, i)] = {static_cast<double>(name)};
        }
    }
    gl.ActiveTexture(static_cast<GLenum>(active));
    for (GLuint i = 0; i < kAttributes; ++i) {
        std::vector<double> values;
        for (const GLenum name : {GL_VERTEX_ATTRIB_ARRAY_ENABLED, GL_VERTEX_ATTRIB_ARRAY_SIZE,
                                  GL_VERTEX_ATTRIB_ARRAY_STRIDE, GL_VERTEX_ATTRIB_ARRAY_TYPE,
                                  GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING}) {
            GLint value = 0;
            gl.GetVertexAttribiv(i, name, &value);
            values.push_back(value);
        }
        state[indexed("vertex attribute", i)] = values;
    }
    for (const GLenum target : {GL_SAMPLES_PASSED, GL_PRIMITIVES_GENERATED, GL_TIME_ELAPSED}) {
        GLint query = 0;
        gl.GetQueryiv(target, GL_CURRENT_QUERY, &query);
        state[indexed("current query", target)] = {static_cast<double>(query)};
    }
    void* callback = nullptr;
    gl.GetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback);
    state["GL_DEBUG_CALLBACK_FUNCTION"] = {
        static_cast<double>(reinterpret_cast<std::uintptr_t>(callback))};
    return state;
}

std::vector<std::string> differences(const GlState& before, const GlState& after) {
    const auto print = [](const std::vector<double>& values) {
        std::string text;
        for (const double value : values) {
            char number[32];
            std::snprintf(number, sizeof number, " %.9g", value);
            text += number;
        }
        return text;
    };
    std::vector<std::string> lines;
    for (const auto& [name, values] : before)
        if (const auto found = after.find(name); found == after.end() || found->second != values)
            lines.push_back(name + ":" + print(values) + " ->" +
                            (found == after.end() ? " missing" : print(found->second)));
    return lines;
}

} // namespace lamina::test
