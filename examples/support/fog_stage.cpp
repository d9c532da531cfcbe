#include "fog_stage.hpp"

#include "check.hpp"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <cmath>

namespace example {
namespace {

constexpr const char* kFragmentShader = R"(#version 450
layout(location = 4) uniform vec3 albedo;
layout(location = 5) uniform vec3 glow;
layout(location = 6) uniform vec3 toViewer;
layout(binding = 0) uniform sampler2D picture;
layout(location = 7) uniform int hasPicture;
in vec3 world;
layout(location = 0) out vec4 outNormal;
layout(location = 1) out vec4 outAlbedo;
layout(location = 2) out vec4 outColor;
layout(location = 8) uniform mat4 worldToPicture;
void main() {
    vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
    bool glows = glow != vec3(0.0);
    outNormal = vec4(glows ? vec3(0.0) : normal, 0.0);
    outAlbedo = vec4(albedo, 1.0);
    vec2 place = (worldToPicture * vec4(world, 1.0)).xy;
    outColor = vec4(hasPicture != 0 ? glow * textureLod(picture, place, 0.0).rgb : glow, 1.0);
}
)";

lamina::headless::Context makeContext() {
    return check(lamina::headless::Context::create());
}

lamina::Device makeDevice(lamina::headless::Context& context) {
    return check(lamina::Device::fromCurrentContext(
        [&](const char* name) { return context.getProcAddress(name); }));
}

std::uint8_t toDisplay(float linear) {
    const float mapped = 1.0f - std::exp(-1.1f * std::max(linear, 0.0f));
    return static_cast<std::uint8_t>(std::lround(255.0f * std::pow(mapped, 1.0f / 2.2f)));
}

} // namespace

FogStage::FogStage()
    : mContext(makeContext())
    , mGl([this](const char* name) { return mContext.getProcAddress(name); })
    , mDevice(makeDevice(mContext))
    , mProgram(makeProgram(
          mGl, {{GL_VERTEX_SHADER, kWorldVertexShader}, {GL_FRAGMENT_SHADER, kFragmentShader}})) {
    mGl.CreateFramebuffers(1, &mFramebuffer);
}

void FogStage::add(const lamina::TriangleMesh& mesh, const glm::vec3& albedo) {
    mParts.push_back({.mesh = upload(mGl, mesh), .albedo = albedo});
    mCasters.emplace_back(mParts.back().mesh.view);
}

void FogStage::addGlow(const glm::vec3 (&corners)[4], const glm::vec3& radiance,
                       std::uint32_t texture) {
    lamina::TriangleMesh mesh;
    mesh.positions.assign(std::begin(corners), std::end(corners));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mGlows.push_back({.mesh = upload(mGl, mesh), .glow = radiance, .texture = texture});
    const glm::vec3 u = corners[1] - corners[0];
    const glm::vec3 v = corners[3] - corners[0];
    const glm::vec3 rows[2] = {u / glm::dot(u, u), v / glm::dot(v, v)};
    glm::mat4 toPicture(0.0f);
    for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 3; ++column)
            toPicture[column][row] = rows[row][column];
        toPicture[3][row] = -glm::dot(rows[row], corners[0]);
    }
    mGl.ProgramUniformMatrix4fv(mProgram, 8, 1, GL_FALSE, glm::value_ptr(toPicture));
}

void FogStage::removeGlows() {
    mGlows.clear();
}

std::uint32_t FogStage::makeTexture(const std::vector<glm::vec3>& texels, const glm::uvec2& size) {
    GLuint texture = 0;
    mGl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    const auto levels = static_cast<GLsizei>(std::log2(std::max(size.x, size.y))) + 1;
    const auto width = static_cast<GLsizei>(size.x);
    const auto height = static_cast<GLsizei>(size.y);
    mGl.TextureStorage2D(texture, levels, GL_RGBA16F, width, height);
    mGl.TextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGB, GL_FLOAT, texels.data());
    mGl.TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    mGl.TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    mGl.GenerateTextureMipmap(texture);
    return texture;
}

void FogStage::draw(const glm::dmat4& worldToClip, const glm::uvec2& size) {
    constexpr GLenum kFormats[4] = {GL_DEPTH_COMPONENT32F, GL_RGBA16F, GL_RGBA8, GL_RGBA16F};
    mGl.DeleteTextures(4, mTextures);
    mGl.CreateTextures(GL_TEXTURE_2D, 4, mTextures);
    for (int i = 0; i < 4; ++i) {
        mGl.TextureStorage2D(mTextures[i], 1, kFormats[i], static_cast<GLsizei>(size.x),
                             static_cast<GLsizei>(size.y));
        const GLenum attachment =
            i == 0 ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i - 1);
        mGl.NamedFramebufferTexture(mFramebuffer, attachment, mTextures[i], 0);
    }
    const GLenum outputs[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    mGl.NamedFramebufferDrawBuffers(mFramebuffer, 3, outputs);
    const float farthest = 1.0f;
    const float nothing[4] = {};
    mGl.ClearNamedFramebufferfv(mFramebuffer, GL_DEPTH, 0, &farthest);
    for (int i = 0; i < 3; ++i)
        mGl.ClearNamedFramebufferfv(mFramebuffer, GL_COLOR, i, nothing);
    mGl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, mFramebuffer);
    mGl.Viewport(0, 0, static_cast<GLsizei>(size.x), static_cast<GLsizei>(size.y));
    mGl.Enable(GL_DEPTH_TEST);
    mGl.UseProgram(mProgram);
    const glm::mat4 matrix(worldToClip);
    mGl.ProgramUniformMatrix4fv(mProgram, 0, 1, GL_FALSE, glm::value_ptr(matrix));
    for (const std::vector<Part>* parts : {&mParts, &mGlows})
        for (const Part& part : *parts) {
            mGl.ProgramUniform3fv(mProgram, 4, 1, glm::value_ptr(part.albedo));
            mGl.ProgramUniform3fv(mProgram, 5, 1, glm::value_ptr(part.glow));
            mGl.ProgramUniform1i(mProgram, 7, part.texture != 0 ? 1 : 0);
            mGl.BindTextureUnit(0, part.texture);
            example::draw(mGl, part.mesh);
        }
    mView = {};
    mView.worldToClip = worldToClip;
    mView.size = size;
    mSurfaces = {};
    mSurfaces.depth = mTextures[0];
    mSurfaces.normal = mTextures[1];
    mSurfaces.albedo = mTextures[2];
    mSurfaces.color = mTextures[3];
}

lamina::Image FogStage::light(const lamina::AreaLightDesc& desc, const lamina::LightSource& light,
                              const lamina::Medium& medium, bool withShadows) {
    lamina::AreaLight effect = check(lamina::AreaLight::create(mDevice, desc));
    std::span<const lamina::GeometrySource> sources = mCasters;
    check(effect.prepare(mView, light, medium, withShadows ? sources : sources.first(0)));
    return toImage(check(effect.apply(mView, mSurfaces)));
}

lamina::Image FogStage::toImage(std::uint32_t texture) const {
    const glm::uvec2 size = mView.size;
    std::vector<glm::vec4> texels(std::size_t{size.x} * size.y);
    mGl.GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT,
                        static_cast<GLsizei>(texels.size() * sizeof texels[0]), texels.data());
    lamina::Image image{size.x, size.y, {}};
    for (std::uint32_t y = 0; y < size.y; ++y)
        for (std::uint32_t x = 0; x < size.x; ++x) {
            const glm::vec4& texel = texels[std::size_t{size.y - 1 - y} * size.x + x];
            for (int i = 0; i < 3; ++i)
                image.rgba.push_back(toDisplay(texel[i]));
            image.rgba.push_back(255);
        }
    return image;
}

lamina::Image montage(const std::vector<lamina::Image>& images, unsigned columns) {
    const std::uint32_t width = images.front().width;
    const std::uint32_t height = images.front().height;
    const auto rows = static_cast<std::uint32_t>((images.size() + columns - 1) / columns);
    lamina::Image whole{width * columns, height * rows, {}};
    whole.rgba.assign(std::size_t{4} * whole.width * whole.height, 255);
    for (std::size_t i = 0; i < images.size(); ++i)
        for (std::uint32_t y = 0; y < height; ++y) {
            const std::size_t row = i / columns * height + y;
            const std::size_t to = 4 * (row * whole.width + i % columns * width);
            std::copy_n(images[i].rgba.begin() + static_cast<std::ptrdiff_t>(4) * y * width,
                        std::size_t{4} * width,
                        whole.rgba.begin() + static_cast<std::ptrdiff_t>(to));
        }
    return whole;
}

lamina::Image difference(const lamina::Image& a, const lamina::Image& b, int gain) {
    lamina::Image image = a;
    for (std::size_t i = 0; i < image.rgba.size(); ++i) {
        const int apart = std::abs(int{a.rgba[i]} - int{b.rgba[i]});
        image.rgba[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(std::min(gain * apart, 255));
    }
    return image;
}

} // namespace example
