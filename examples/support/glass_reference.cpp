#include "glass_reference.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace example {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

class Ball : public GlassBody {
public:
    Ball(const glm::dvec3& center, double radius, double index, bool isHole)
        : mCenter(center)
        , mRadius(radius)
        , mIndex(index)
        , mSide(isHole ? -1.0 : 1.0) {}

    std::optional<GlassHit> hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                double least) const override {
        const glm::dvec3 offset = origin - mCenter;
        const double b = glm::dot(offset, direction);
        const double root = b * b - glm::dot(offset, offset) + mRadius * mRadius;
        if (root < 0.0)
            return {};
        for (const double distance : {-b - std::sqrt(root), -b + std::sqrt(root)})
            if (distance > least)
                return GlassHit{distance, mSide * (offset + distance * direction) / mRadius,
                                mIndex};
        return {};
    }

private:
    glm::dvec3 mCenter;
    double mRadius, mIndex, mSide;
};

class Box : public GlassBody {
public:
    Box(const glm::dvec3& min, const glm::dvec3& max, double index)
        : mMin(min)
        , mMax(max)
        , mIndex(index) {}

    std::optional<GlassHit> hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                double least) const override {
        GlassHit enters{-kNowhere, {}, mIndex}, leaves{kNowhere, {}, mIndex};
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 normal(0.0);
            normal[axis] = direction[axis] > 0.0 ? -1.0 : 1.0;
            const double near = (direction[axis] > 0.0 ? mMin : mMax)[axis];
            const double far = (direction[axis] > 0.0 ? mMax : mMin)[axis];
            const double first = (near - origin[axis]) / direction[axis];
            const double last = (far - origin[axis]) / direction[axis];
            if (first > enters.distance)
                enters = {first, normal, mIndex};
            if (last < leaves.distance)
                leaves = {last, -normal, mIndex};
        }
        if (enters.distance > leaves.distance)
            return {};
        for (const GlassHit& hit : {enters, leaves})
            if (hit.distance > least)
                return hit;
        return {};
    }

private:
    glm::dvec3 mMin, mMax;
    double mIndex;
};

class Revolved : public GlassBody {
public:
    Revolved(std::span<const glm::vec2> profile, double index)
        : mProfile(profile.begin(), profile.end())
        , mNormals(profileNormals(profile))
        , mIndex(index) {}

    std::optional<GlassHit> hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                double least) const override {
        double nearest = kNowhere;
        std::size_t piece = 0;
        double share = 0.0;
        for (std::size_t i = 0; i + 1 < mProfile.size(); ++i)
            hitPiece(i, origin, direction, least, nearest, piece, share);
        if (nearest == kNowhere)
            return {};
        const glm::dvec3 point = origin + nearest * direction;
        const glm::dvec2 normal =
            glm::normalize(glm::mix(mNormals[piece], mNormals[piece + 1], share));
        const double radius = std::max(std::hypot(point.x, point.z), 1e-12);
        return GlassHit{
            nearest, {normal.x * point.x / radius, normal.y, normal.x * point.z / radius}, mIndex};
    }

private:
    /// Piece i sweeps a cone; `share`: where on it the hit is, from 0 to 1.
    void hitPiece(std::size_t i, const glm::dvec3& origin, const glm::dvec3& direction,
                  double least, double& nearest, std::size_t& piece, double& share) const {
        const glm::dvec2 a(mProfile[i]);
        const glm::dvec2 b(mProfile[i + 1]);
        const auto offer = [&](double distance, double at) {
            if (distance > least && distance < nearest && at >= 0.0 && at <= 1.0) {
                nearest = distance;
                piece = i;
                share = at;
            }
        };
        if (a.y == b.y) {
            const double distance = (a.y - origin.y) / direction.y;
            const glm::dvec3 point = origin + distance * direction;
            offer(distance, (std::hypot(point.x, point.z) - a.x) / (b.x - a.x));
            return;
        }
        const double slope = (b.x - a.x) / (b.y - a.y);
        const double r = a.x + slope * (origin.y - a.y);
        const double dr = slope * direction.y;
        const double qa = direction.x * direction.x + direction.z * direction.z - dr * dr;
        const double qb = origin.x * direction.x + origin.z * direction.z - r * dr;
        const double qc = origin.x * origin.x + origin.z * origin.z - r * r;
        const double root = qb * qb - qa * qc;
        if (root < 0.0 || qa == 0.0)
            return;
        for (const double sign : {-1.0, 1.0}) {
            const double distance = (-qb + sign * std::sqrt(root)) / qa;
            if (r + distance * dr >= 0.0)
                offer(distance, (origin.y + distance * direction.y - a.y) / (b.y - a.y));
        }
    }

    std::vector<glm::vec2> mProfile;
    std::vector<glm::dvec2> mNormals;
    double mIndex;
};

/// Snell's law; nothing for total reflection. eta: index before by index behind.
std::optional<glm::dvec3> refracted(const glm::dvec3& direction, const glm::dvec3& normal,
                                    double eta) {
    const double cosine = glm::dot(direction, normal);
    const double root = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (root < 0.0)
        return {};
    return glm::normalize(eta * direction - (eta * cosine + std::sqrt(root)) * normal);
}

} // namespace

std::unique_ptr<GlassBody> makeGlassBall(const glm::dvec3& center, double radius, double index,
                                         bool isHole) {
    return std::make_unique<Ball>(center, radius, index, isHole);
}

std::unique_ptr<GlassBody> makeGlassBox(const glm::dvec3& min, const glm::dvec3& max,
                                        double index) {
    return std::make_unique<Box>(min, max, index);
}

std::unique_ptr<GlassBody> makeRevolvedGlass(std::span<const glm::vec2> profile, double index) {
    return std::make_unique<Revolved>(profile, index);
}

std::vector<glm::dvec2> profileNormals(std::span<const glm::vec2> profile) {
    std::vector<glm::dvec2> normals(profile.size(), glm::dvec2(0.0));
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const glm::dvec2 along = glm::normalize(glm::dvec2(profile[i + 1] - profile[i]));
        normals[i] += glm::dvec2(along.y, -along.x);
        normals[i + 1] += glm::dvec2(along.y, -along.x);
    }
    for (glm::dvec2& normal : normals)
        normal = glm::normalize(normal);
    normals.front() = {0.0, normals.front().y < 0.0 ? -1.0 : 1.0};
    normals.back() = {0.0, normals.back().y < 0.0 ? -1.0 : 1.0};
    return normals;
}

std::optional<GlassHit> hitGlass(std::span<const std::unique_ptr<GlassBody>> bodies,
                                 const glm::dvec3& origin, const glm::dvec3& direction,
                                 double least) {
    std::optional<GlassHit> nearest;
    for (const auto& body : bodies) {
        const auto hit = body->hit(origin, direction, least);
        if (hit && (!nearest || hit->distance < nearest->distance))
            nearest = hit;
    }
    return nearest;
}

GlassPath traceGlass(std::span<const std::unique_ptr<GlassBody>> bodies, const glm::dvec3& surface,
                     const GlassHit& first, const glm::dvec3& direction, int maxEvents) {
    constexpr double kLeast = 1e-7;
    std::vector<double> media = {1.0, first.index};
    GlassPath path{surface, *refracted(direction, first.normal, 1.0 / first.index)};
    while (path.events < maxEvents) {
        const auto hit = hitGlass(bodies, path.exit, path.direction, kLeast);
        if (!hit)
            break;
        path.exit += hit->distance * path.direction;
        path.inside += media.size() > 1 ? hit->distance : 0.0;
        ++path.events;
        const bool isEntering = glm::dot(path.direction, hit->normal) < 0.0;
        if (!isEntering && media.size() == 1)
            continue;
        const glm::dvec3 towards = isEntering ? hit->normal : -hit->normal;
        const double behind = isEntering ? hit->index : media[media.size() - 2];
        const auto bent = refracted(path.direction, towards, media.back() / behind);
        if (!bent) {
            path.direction = glm::reflect(path.direction, towards);
            ++path.reflections;
            continue;
        }
        path.direction = *bent;
        if (isEntering)
            media.push_back(hit->index);
        else
            media.pop_back();
    }
    return path;
}

} // namespace example
