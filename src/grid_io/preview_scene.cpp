#include "grid_io/preview_scene.hpp"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamina::detail {
namespace {

// Light arriving from the sun straight on and from a sky without obstacles, linear.
const glm::vec3 kSunLight(1.75f, 1.61f, 1.40f);
const glm::vec3 kSkyLight(0.54f, 0.62f, 0.76f);
/// What a ray finds that leaves downwards: the ground's reflection.
const glm::vec3 kGroundLight(0.44f, 0.42f, 0.40f);
const glm::vec3 kShadowColor(0.055f, 0.065f, 0.10f);
/// Light that reaches a surface by way of others, as a share of the sky's.
constexpr float kBounce = 0.42f;
constexpr double kSunRadius = 0.035; ///< Tangent of the sun's angular radius: soft shadow edges.
constexpr int kGroundSkyRays = 2;    ///< A plain ground shows noise that a model's surface hides.

float square(float x) {
    return x * x;
}

double fraction(double x) {
    return x - std::floor(x);
}

double smooth(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

std::uint32_t hash(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ x >> 16;
}

double unit(std::uint32_t bits) {
    return bits * (1.0 / 4294967296.0);
}

/// Two unit vectors that complete `normal` to an orthogonal frame.
void frame(const glm::dvec3& normal, glm::dvec3& tangent, glm::dvec3& bitangent) {
    const glm::dvec3 helper = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    tangent = glm::normalize(glm::cross(helper, normal));
    bitangent = glm::cross(normal, tangent);
}

/// A direction about `normal`, its probability the cosine to it.
glm::dvec3 cosineDirection(const glm::dvec3& normal, double u, double v) {
    glm::dvec3 tangent, bitangent;
    frame(normal, tangent, bitangent);
    const double radius = std::sqrt(u);
    const double angle = 2.0 * std::numbers::pi * v;
    return radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent +
           std::sqrt(std::max(0.0, 1.0 - u)) * normal;
}

/// Keeps dark and middle tones and rolls highlights off below 1, without a change of hue.
glm::vec3 rollOff(const glm::vec3& color) {
    constexpr float knee = 0.55f;
    const float most = std::max({color.r, color.g, color.b});
    if (most <= knee)
        return color;
    return color *
           ((knee + (1.0f - knee) * (1.0f - std::exp((knee - most) / (1.0f - knee)))) / most);
}

float linearFromSrgb(float value) {
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

/// By 8-bit value.
const std::array<float, 256> kLinear = [] {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = linearFromSrgb(static_cast<float>(i) / 255.0f);
    return table;
}();

} // namespace

glm::vec3 linearFromSrgb(const glm::vec3& color) {
    return {linearFromSrgb(color.r), linearFromSrgb(color.g), linearFromSrgb(color.b)};
}

glm::vec3 srgbFromLinear(const glm::vec3& color) {
    glm::vec3 result;
    for (int i = 0; i < 3; ++i)
        result[i] = color[i] <= 0.0031308f ? color[i] * 12.92f
                                           : 1.055f * std::pow(color[i], 1.0f / 2.4f) - 0.055f;
    return result;
}

/// Numbers in [0,1) for one sample: evenly spread over a pixel's samples, shifted at random from
/// pixel to pixel.
struct PreviewScene::Randoms {
    double skyU, skyV, sunU, sunV;

    Randoms(std::uint32_t seed, std::uint32_t index)
        // Powers of the inverse root of x^5 = x + 1: the plastic number's kin for four dimensions.
        : skyU(fraction(unit(hash(seed)) + 0.8566748838545029 * index))
        , skyV(fraction(unit(hash(seed + 1)) + 0.7338918566271260 * index))
        , sunU(fraction(unit(hash(seed + 2)) + 0.6287067210378087 * index))
        , sunV(fraction(unit(hash(seed + 3)) + 0.5385972572236101 * index)) {}
};

struct PreviewScene::Surface {
    glm::dvec3 position; ///< Slightly off the surface, world.
    glm::dvec3 normal;   ///< Of the face, unit, world.
    glm::dvec3 bevel;    ///< Of the rounded edge near a voxel's border, else `normal`.
    glm::vec3 albedo;
};

PreviewScene::PreviewScene(const BoxVoxels& voxels, const PreviewDesc& desc)
    : mVoxels(voxels)
    , mTree(voxels)
    , mDesc(desc)
    , mCamera(voxels.bounds(), desc)
    , mOrigin(voxels.bounds().min)
    , mEdge(voxels.voxelSize())
    , mUp(glm::normalize(desc.up))
    // Over the photographer's left shoulder, whatever the view; from the front where it looks up.
    , mSun(glm::normalize(mUp - 0.75 * mCamera.right - 0.42 * mCamera.forward))
    , mOffset(1e-4 * std::min({mEdge.x, mEdge.y, mEdge.z}))
    , mLowColor(linearFromSrgb(desc.lowColor))
    , mHighColor(linearFromSrgb(desc.highColor))
    , mBackgroundTop(linearFromSrgb(desc.backgroundTop))
    , mBackgroundBottom(linearFromSrgb(desc.backgroundBottom)) {
    if (mTree.isEmpty())
        return;
    const glm::dvec3 low = mOrigin + glm::dvec3(mTree.low()) * mEdge;
    const glm::dvec3 high = mOrigin + glm::dvec3(mTree.high()) * mEdge;
    const glm::dvec3 reach = 0.5 * (high - low) * glm::abs(mUp);
    const double middle = glm::dot(0.5 * (low + high), mUp);
    const double half = reach.x + reach.y + reach.z;
    mFoot = middle - half;
    mHeight = 2.0 * half;
    mHasGround = desc.ground && glm::dot(mCamera.eye, mUp) > mFoot;
}

glm::vec4 PreviewScene::samples(std::uint32_t x, std::uint32_t y, std::uint32_t first,
                                std::uint32_t end) const {
    const std::uint32_t seed = hash(x + 0x9e3779b9u * hash(y));
    glm::vec4 sum(0.0f);
    for (std::uint32_t i = first; i < end; ++i) {
        // Powers of the plastic number's inverse: any run of samples covers the pixel evenly.
        const glm::dvec2 offset(fraction(0.5 + 0.7548776662466927 * i),
                                fraction(0.5 + 0.5698402909980532 * i));
        sum += sample(glm::dvec2(x, y) + offset, Randoms(seed, i));
    }
    return sum;
}

VoxelRay PreviewScene::voxelRay(const glm::dvec3& origin, const glm::dvec3& direction) const {
    return {(origin - mOrigin) / mEdge, direction / mEdge};
}

glm::vec4 PreviewScene::sample(const glm::dvec2& pixel, const Randoms& randoms) const {
    const glm::dvec3 direction = mCamera.direction(pixel);
    const auto hit =
        mTree.cast(voxelRay(mCamera.eye, direction), std::numeric_limits<double>::infinity());
    if (hit) {
        const Surface seen = surface(*hit, mCamera.eye + hit->distance * direction);
        return {rollOff(shade(seen, randoms)), 1.0f};
    }
    return ground(direction, randoms);
}

glm::vec4 PreviewScene::background(std::uint32_t y) const {
    if (mDesc.transparentBackground)
        return glm::vec4(0.0f);
    const auto share = static_cast<float>((y + 0.5) / mCamera.pixels.y);
    return {glm::mix(mBackgroundTop, mBackgroundBottom, share), 1.0f};
}

/// The shadow on the ground, a thin dark layer: linear colour premultiplied by its alpha.
glm::vec4 PreviewScene::ground(const glm::dvec3& direction, const Randoms& randoms) const {
    const double slope = glm::dot(direction, mUp);
    if (!mHasGround || slope >= 0.0)
        return glm::vec4(0.0f);
    const double distance = (mFoot - glm::dot(mCamera.eye, mUp)) / slope;
    const glm::dvec3 position = mCamera.eye + distance * direction + mOffset * mUp;
    int open = 0;
    for (int i = 0; i < kGroundSkyRays; ++i) {
        const double u = fraction(randoms.skyU + i * 0.754877666246693);
        const double v = fraction(randoms.skyV + i * 0.569840290998053);
        open += !mTree.cast(voxelRay(position, cosineDirection(mUp, u, v)),
                            std::numeric_limits<double>::infinity());
    }
    const float sun = static_cast<float>(std::max(0.0, glm::dot(mSun, mUp))) * kSunLight.g;
    const float sky = kSkyLight.g;
    const float lit = (sunReaches(position, randoms) ? sun : 0.0f) +
                      sky * static_cast<float>(open) / static_cast<float>(kGroundSkyRays);
    const float alpha = 0.92f * (1.0f - lit / (sun + sky));
    return {alpha * kShadowColor, alpha};
}

PreviewScene::Surface PreviewScene::surface(const VoxelHit& hit, const glm::dvec3& position) const {
    Surface result;
    result.normal = glm::dvec3(0.0);
    result.normal[hit.axis] = hit.side;
    result.position = position + mOffset * result.normal;
    result.bevel = result.normal;
    result.albedo = albedo(hit.voxel);

    const double edge = std::min({mEdge.x, mEdge.y, mEdge.z});
    const double pixel = mCamera.pixelWidth(glm::dot(position - mCamera.eye, mCamera.forward));
    const double detail = mDesc.edges ? smooth(2.5, 9.0, edge / pixel) : 0.0;
    if (detail == 0.0)
        return result;
    // Blocks differ a little, as bricks do.
    const std::uint32_t own = hash(static_cast<std::uint32_t>(hit.voxel.x) +
                                   hash(static_cast<std::uint32_t>(hit.voxel.y) +
                                        hash(static_cast<std::uint32_t>(hit.voxel.z))));
    result.albedo *= 1.0f + static_cast<float>(0.09 * detail * (unit(own) - 0.5));

    const double bevelWidth = 0.10 * edge;
    const double jointWidth = std::max(0.030 * edge, 0.6 * pixel);
    const glm::dvec3 inside = (position - mOrigin) / mEdge - glm::dvec3(hit.voxel);
    glm::ivec3 outward(0);
    outward[hit.axis] = hit.side;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis == hit.axis)
            continue;
        glm::ivec3 step(0);
        step[axis] = inside[axis] < 0.5 ? -1 : 1;
        const double border =
            (inside[axis] < 0.5 ? inside[axis] : 1.0 - inside[axis]) * mEdge[axis];
        if (border > bevelWidth || mTree.test(hit.voxel + step + outward))
            continue;
        if (!mTree.test(hit.voxel + step))
            result.bevel[axis] += step[axis] * detail * (1.0 - std::max(border, 0.0) / bevelWidth);
        else if (border < jointWidth)
            result.albedo *= static_cast<float>(1.0 - 0.30 * detail * (1.0 - border / jointWidth));
    }
    result.bevel = glm::normalize(result.bevel);
    return result;
}

glm::vec3 PreviewScene::albedo(const glm::ivec3& voxel) const {
    if (mVoxels.hasColors())
        if (const glm::u8vec4 color = mVoxels.color(glm::uvec3(voxel)); color != glm::u8vec4(0))
            return {kLinear[color.r], kLinear[color.g], kLinear[color.b]};
    const double height = glm::dot(mOrigin + (glm::dvec3(voxel) + 0.5) * mEdge, mUp) - mFoot;
    const auto share = static_cast<float>(smooth(0.0, 1.0, height / mHeight));
    return glm::mix(mLowColor, mHighColor, share);
}

glm::vec3 PreviewScene::shade(const Surface& surface, const Randoms& randoms) const {
    glm::vec3 light = skyLight(surface, randoms);
    const double facing = glm::dot(surface.bevel, mSun);
    if (facing > 0.0 && glm::dot(surface.normal, mSun) > -0.5 &&
        sunReaches(surface.position, randoms))
        light += static_cast<float>(facing) * kSunLight;
    return surface.albedo * light;
}

glm::vec3 PreviewScene::skyLight(const Surface& surface, const Randoms& randoms) const {
    const glm::dvec3 direction = cosineDirection(surface.normal, randoms.skyU, randoms.skyV);
    const auto hit =
        mTree.cast(voxelRay(surface.position, direction), std::numeric_limits<double>::infinity());
    if (hit)
        return kBounce * kSkyLight * albedo(hit->voxel);
    const auto height = static_cast<float>(smooth(-0.4, 0.6, glm::dot(direction, mUp)));
    return glm::mix(kGroundLight, kSkyLight, square(height));
}

bool PreviewScene::sunReaches(const glm::dvec3& position, const Randoms& randoms) const {
    glm::dvec3 tangent, bitangent;
    frame(mSun, tangent, bitangent);
    const double radius = kSunRadius * std::sqrt(randoms.sunU);
    const double angle = 2.0 * std::numbers::pi * randoms.sunV;
    const glm::dvec3 direction =
        mSun + radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent;
    return !mTree.cast(voxelRay(position, direction), std::numeric_limits<double>::infinity());
}

} // namespace lamina::detail
