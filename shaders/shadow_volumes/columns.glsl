// Finds the texels of the light's map that a triangle touches: draws the rectangle around it on each face
// that shows visible points; the fragment stage rejects what the triangle does not reach. No clipping:
// edges are planes through the light, which hold for triangles that pass behind it too (Olano & Greer
// 1997).
//
// includer declares `layout(...) in` and calls laminaEmitColumns(); at most 4 vertices a face.
// LAMINA_SHADOW_WITH_LAYERS 1, defined before: also what the fragment stage needs for the triangle's layers.
#define LAMINA_SHADOW_BOUNDS_ACCESS readonly
#include <shadow_volumes/bounds.glsl>

layout(triangle_strip, max_vertices = 24) out;

layout(location = 0) flat out vec3 laminaEdges[3];   // inside: positive; of (texel - corner, 1)
layout(location = 3) flat out vec4 laminaBox;        // texels that bound it
layout(location = 4) flat out vec3 laminaFarPlane;   // farness of (texel - corner, 1)
layout(location = 5) flat out vec3 laminaFarRange;   // least and greatest farness; face
layout(location = 9) flat out vec2 laminaCorner;     // texel that the planes are relative to
#if LAMINA_SHADOW_WITH_LAYERS
layout(location = 6) flat out vec3 laminaLayerPlane; // layer coordinate * view w, over light w
layout(location = 7) flat out vec3 laminaViewPlane;  // view w, over light w
layout(location = 8) flat out vec2 laminaLayerRange; // of the corners
#endif

void laminaEmitFace(uint face, vec3 corners[3]) {
    if (laminaFaceEmpty(face))
        return;
    LaminaFaceMap map = laminaFaceMap(face);
    float side = float(laminaFrame.size.z);
    vec3 texel[3];
    vec3 farness;
    vec3 w;
    for (int i = 0; i < 3; ++i) {
        LaminaFacePoint point = laminaFacePoint(face, corners[i]);
        texel[i] = laminaToTexel(map, point.position);
        farness[i] = point.farness;
        w[i] = texel[i].z;
    }
    if (all(lessThanEqual(w, vec3(0.0))))
        return;
    bool isAhead = all(greaterThan(w, vec3(0.0)));
    vec4 box = vec4(0.0, 0.0, side, side);
    vec2 farRange = vec2(-3.0e38, 3.0e38);
    if (isAhead) {
        vec2 a = texel[0].xy / w.x, b = texel[1].xy / w.y, c = texel[2].xy / w.z;
        box = vec4(min(a, min(b, c)), max(a, max(b, c)));
        vec3 far = farness / w;
        farRange = vec2(min(far.x, min(far.y, far.z)), max(far.x, max(far.y, far.z)));
    }
    vec4 drawn = clamp(vec4(floor(box.xy - LAMINA_SHADOW_REACH), ceil(box.zw + LAMINA_SHADOW_REACH)), 0.0, side);
    if (!(drawn.x < drawn.z && drawn.y < drawn.w))
        return;

    // Relative to the rectangle's corner, so that small triangles keep their digits.
    vec3 p[3];
    for (int i = 0; i < 3; ++i)
        p[i] = vec3(texel[i].xy - drawn.xy * w[i], w[i]);
    vec3 edges[3] = vec3[3](cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1]));
    float volume = dot(p[0], edges[0]);
    float orientation = volume < 0.0 ? -1.0 : 1.0;
    vec3 farPlane = (edges[0] * farness.x + edges[1] * farness.y + edges[2] * farness.z) / volume;
#if LAMINA_SHADOW_WITH_LAYERS
    vec2 layer[3];
    for (int i = 0; i < 3; ++i)
        layer[i] = laminaShadowClipLayer(laminaFrame.originToClip * vec4(corners[i], 1.0));
    vec3 layerPlane = (edges[0] * layer[0].x + edges[1] * layer[1].x + edges[2] * layer[2].x) / volume;
    vec3 viewPlane = (edges[0] * layer[0].y + edges[1] * layer[1].y + edges[2] * layer[2].y) / volume;
    vec2 layerRange = vec2(0.0, float(laminaFrame.counts.x));
    if (min(layer[0].y, min(layer[1].y, layer[2].y)) > 0.0) {
        vec3 at = vec3(layer[0].x / layer[0].y, layer[1].x / layer[1].y, layer[2].x / layer[2].y);
        layerRange = vec2(min(at.x, min(at.y, at.z)), max(at.x, max(at.y, at.z)));
    }
#endif
    for (int corner = 0; corner < 4; ++corner) {
        vec2 at = vec2((corner & 1) == 0 ? drawn.x : drawn.z, (corner & 2) == 0 ? drawn.y : drawn.w);
        gl_Position = vec4(at / side * 2.0 - 1.0, 0.0, 1.0);
        gl_Layer = int(face);
        laminaEdges = vec3[3](edges[0] * orientation, edges[1] * orientation, edges[2] * orientation);
        laminaBox = box - drawn.xyxy;
        laminaCorner = drawn.xy;
        laminaFarPlane = farPlane;
        laminaFarRange = vec3(farRange, float(face));
#if LAMINA_SHADOW_WITH_LAYERS
        laminaLayerPlane = layerPlane;
        laminaViewPlane = viewPlane;
        laminaLayerRange = layerRange;
#endif
        EmitVertex();
    }
    EndPrimitive();
}

void laminaEmitColumns(vec3 a, vec3 b, vec3 c) {
    for (uint face = 0u; face < laminaFrame.size.w; ++face)
        laminaEmitFace(face, vec3[3](a, b, c));
}
