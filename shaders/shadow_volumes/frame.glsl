// The frame's constants; layers of the view; faces of the light's map.
//
// Layers ([ED06] 3.2, Lloyd et al. 2004): the planes between them contain the viewpoint, so that each is a
// straight strip of the picture and each pixel lies in exactly one; they cross the picture at right angles
// to the light's projected direction. A volume clamped to layers therefore needs no caps on their planes:
// it is the whole volume, seen through the strips.
//
// The light's map: one face for a directional light, six faces of a cube for a point light, each fitted to
// the visible points that it holds.
#include <lamina/shared/shadow_volumes_block.glsl>

layout(std140, binding = LAMINA_SHADOW_FRAME_BINDING) uniform LaminaShadowFrameBlock {
    LaminaShadowFrame laminaFrame;
};

// From a pixel (centres at half integers). The same for the same pixel in every stage.
float laminaShadowLayerCoordinate(vec2 pixel) {
    precise float coordinate = laminaFrame.layerAxis.x * pixel.x + laminaFrame.layerAxis.y * pixel.y + laminaFrame.layerAxis.z;
    return coordinate;
}

uint laminaShadowLayer(vec2 pixel) {
    return uint(clamp(int(floor(laminaShadowLayerCoordinate(pixel))), 0, int(laminaFrame.counts.x) - 1));
}

bool laminaShadowLayerSet(uvec4 layers, uint layer) {
    uint word = layer < 32u ? layers.x : layer < 64u ? layers.y : layer < 96u ? layers.z : layers.w;
    return ((word >> (layer & 31u)) & 1u) != 0u;
}

// Layer coordinate * w, and w, of a point in clip space.
vec2 laminaShadowClipLayer(vec4 clip) {
    vec2 pixel = (clip.xy + clip.w) * 0.5 * vec2(laminaFrame.size.xy); // times w
    return vec2(dot(laminaFrame.layerAxis.xyz, vec3(pixel, clip.w)), clip.w);
}

bool laminaIsPointLight() {
    return laminaFrame.light.w != 0.0;
}

// A point in a face's projection: x and y homogeneous, w; and what grows with the distance from the light
// on rays of the light, over w: -1 (so -1 / distance along the face's axis) or the distance itself.
struct LaminaFacePoint {
    vec3 position;
    float farness;
};

LaminaFacePoint laminaFacePoint(uint face, vec3 origin) {
    if (!laminaIsPointLight())
        return LaminaFacePoint(vec3(dot(laminaFrame.lightU.xyz, origin), dot(laminaFrame.lightV.xyz, origin), 1.0),
                               -dot(laminaFrame.light.xyz, origin));
    vec3 d = origin - laminaFrame.light.xyz;
    uint axis = face >> 1;
    vec3 turned = axis == 0u ? d.yzx : axis == 1u ? d.zxy : d;
    if ((face & 1u) != 0u)
        turned.z = -turned.z;
    return LaminaFacePoint(turned, -1.0);
}

// The face that a point belongs to.
uint laminaFaceOf(vec3 origin) {
    if (!laminaIsPointLight())
        return 0u;
    vec3 d = origin - laminaFrame.light.xyz;
    vec3 size = abs(d);
    uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    float along = axis == 0u ? d.x : axis == 1u ? d.y : d.z;
    return 2u * axis + (along < 0.0 ? 1u : 0u);
}
