// Copies what lies behind an object, for look-ups by level and for a host that draws into the same
// texture. One invocation a pixel.
layout(binding = 0) uniform sampler2D laminaSource;
layout(location = 0) out vec4 laminaResult;

void main() {
    laminaResult = texelFetch(laminaSource, ivec2(gl_FragCoord.xy), 0);
}
