#pragma once

#include "gl/support/gl_test.hpp"
#include "gl/support/parity.hpp"

#include <lamina/gl/shaders.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace lamina::test {

inline const Box3 kUnitBox{{-1, -1, -1}, {1, 1, 1}};

/// A shader of `count` sprites that follows `settings` and `file`.
inline std::string parityText(int count, const std::string& settings = {},
                              const char* file = "lamina/parity.glsl") {
    return "#version 450 core\n#define LAMINA_PARITY_COUNT " + std::to_string(count) + "\n" +
           settings + shaderSource(file).value();
}

/// A host that asks lamina/parity.glsl about points.
class ParityQueryGlTest : public GlTest {
protected:
    /// What a compute shader's `vec4 ask(vec3 world)` says of each point.
    std::vector<glm::vec4> ask(const SpriteSet& set, std::span<const glm::vec3> points,
                               const std::string& function,
                               const char* file = "lamina/parity.glsl") {
        const GLuint program =
            buildProgram({{GL_COMPUTE_SHADER, parityText(static_cast<int>(std::max(set.size(), 1u)),
                                                         "#define LAMINA_PARITY_BLOCK_BINDING 3\n"
                                                         "#define LAMINA_PARITY_TEXTURE_UNIT 5\n",
                                                         file) +
                                                  function + R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { float points[]; };
layout(std430, binding = 1) buffer Results { vec4 results[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(results.length()))
        results[i] = ask(vec3(points[3u * i], points[3u * i + 1u], points[3u * i + 2u]));
})"}});
        set.bind(3, 5);
        std::vector<glm::vec4> results(points.size());
        runCompute(program, std::as_bytes(points), std::as_writable_bytes(std::span(results)),
                   static_cast<std::uint32_t>(points.size()));
        gl().DeleteProgram(program);
        return results;
    }
    /// What a batch says, a mask a point.
    std::vector<std::uint32_t> masks(const SpriteSet& set, std::span<const glm::vec3> points,
                                     const PointQuery& query = {.answer = PointAnswer::Masks}) {
        const auto bytes =
            PointClassifier::create(device()).value().download(set, points, query).value();
        std::vector<std::uint32_t> words(bytes.size() / 4);
        std::memcpy(words.data(), bytes.data(), bytes.size());
        return words;
    }
};

} // namespace lamina::test
