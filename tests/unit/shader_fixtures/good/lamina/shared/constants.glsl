#pragma once
// Valid GLSL and C++.

#ifdef __cplusplus
#include <glm/vec4.hpp>
namespace fixture {
using vec4 = glm::vec4;
#endif

#define FIXTURE_WORD_BITS 32

struct FixtureConstants {
    vec4 range;
};

#ifdef __cplusplus
}
#endif
