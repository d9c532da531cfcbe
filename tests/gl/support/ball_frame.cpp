#include "gl/support/ball_frame.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace lamina::test {

void BallFrameTest::SetUp() {
    GlTest::SetUp();
    mView.size = kSize;
    mView.worldToClip = glm::perspective(0.7, static_cast<double>(kSize.x) / kSize.y, 0.5, 40.0) *
                        glm::lookAt(mEye, glm::dvec3(0.0), glm::dvec3(0, 1, 0));
    mClear.refractiveIndex = 1.0f;
}

glm::dvec3 BallFrameTest::ray(unsigned x, unsigned y) const {
    const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / glm::dvec2(kSize) * 2.0 - 1.0;
    const glm::dvec4 far = glm::inverse(mView.worldToClip) * glm::dvec4(at, 0.5, 1.0);
    return glm::normalize(glm::dvec3(far) / far.w - mEye);
}

std::optional<BallHit> BallFrameTest::hitBalls(std::span<const Ball> balls, unsigned x,
                                               unsigned y) const {
    std::optional<BallHit> nearest;
    const glm::dvec3 direction = ray(x, y);
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const glm::dvec3 offset = mEye - balls[i].center;
        const double b = glm::dot(offset, direction);
        const double root = b * b - glm::dot(offset, offset) + balls[i].radius * balls[i].radius;
        if (root < 0.0 || (nearest && nearest->distance < -b - std::sqrt(root)))
            continue;
        nearest = BallHit{i, -b - std::sqrt(root), 2.0 * std::sqrt(root)};
        nearest->normal = (offset + nearest->distance * direction) / balls[i].radius;
    }
    return nearest;
}

BallFrameTest::GBuffer BallFrameTest::draw(std::span<const Ball> balls) {
    std::vector<float> depths(std::size_t{kSize.x} * kSize.y, 1.0f);
    std::vector<glm::vec4> normals(depths.size(), glm::vec4(0.0f));
    std::vector<std::uint32_t> objects(depths.size(), 0);
    for (unsigned y = 0; y < kSize.y; ++y)
        for (unsigned x = 0; x < kSize.x; ++x)
            if (const auto hit = hitBalls(balls, x, y)) {
                const glm::dvec4 clip =
                    mView.worldToClip * glm::dvec4(mEye + hit->distance * ray(x, y), 1.0);
                const std::size_t i = std::size_t{y} * kSize.x + x;
                depths[i] = static_cast<float>(clip.z / clip.w * 0.5 + 0.5);
                normals[i] = glm::vec4(hit->normal, 0.0);
                objects[i] = static_cast<std::uint32_t>(hit->ball) + 1;
            }
    return {texture(GL_R32F, GL_RED, GL_FLOAT, depths),
            texture(GL_RGBA32F, GL_RGBA, GL_FLOAT, normals),
            texture(GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, objects)};
}

RefractionReceiver BallFrameTest::receiverOf(const GBuffer& drawn, std::uint32_t object) const {
    RefractionReceiver receiver;
    receiver.view = mView;
    receiver.depthTexture = drawn.depth.id();
    receiver.normalTexture = drawn.normals.id();
    receiver.objectTexture = object != 0 ? drawn.objects.id() : 0;
    receiver.objectId = object;
    return receiver;
}

std::vector<glm::vec4> BallFrameTest::read(GLuint texture) {
    return readPixels(device(), texture, kSize);
}

glm::vec3 BallFrameTest::cubeDirection(std::size_t texel, unsigned size) {
    const std::size_t face = texel / size / size;
    const float s = 2.0f * (static_cast<float>(texel % size) + 0.5f) / size - 1.0f;
    const float t = 2.0f * (static_cast<float>(texel / size % size) + 0.5f) / size - 1.0f;
    const glm::vec3 directions[] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t},
                                    {s, -1, -t}, {s, -t, 1},  {-s, -t, -1}};
    return glm::normalize(directions[face]);
}

Environment BallFrameTest::environmentOf(const std::vector<glm::vec4>& texels,
                                         const EnvironmentDesc& desc) {
    auto cube = gl::Texture::create(device().state(), "test", GL_TEXTURE_CUBE_MAP);
    const auto size = static_cast<GLsizei>(desc.size);
    gl().TextureStorage2D(cube.id(), 1, GL_RGBA32F, size, size);
    gl().TextureSubImage3D(cube.id(), 0, 0, 0, 0, size, size, 6, GL_RGBA, GL_FLOAT, texels.data());
    auto environment = Environment::create(device(), desc).value();
    const auto loaded = environment.loadCubeMap(cube.id());
    EXPECT_TRUE(loaded) << loaded.error().text;
    return environment;
}

Refraction BallFrameTest::create(RefractionModel model, const Environment& environment) {
    RefractionDesc desc;
    desc.model = model;
    desc.voxels = 64;
    auto refraction = Refraction::create(device(), desc).value();
    refraction.setEnvironment(environment);
    return refraction;
}

} // namespace lamina::test
