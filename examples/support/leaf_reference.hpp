#pragma once

#include <lamina/core/triangle_mesh.hpp>

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <span>

namespace example {

/// Counts by ray casting (Embree) what stands between points and the sun.
class LeafReference {
public:
    /// leaves: of each class.
    LeafReference(std::span<const lamina::TriangleMesh> leaves, const lamina::TriangleMesh& wood);
    ~LeafReference();

    static constexpr std::size_t kMostClasses = 8;
    struct Crossings {
        std::array<unsigned, kMostClasses> leaves{}; ///< Of each class.
        bool isBehindWood = false;
    };
    /// toSun: unit vector. The surface that holds the point does not count.
    [[nodiscard]] Crossings towards(const glm::vec3& point, const glm::vec3& toSun) const;

private:
    struct Impl;
    std::unique_ptr<Impl> mImpl;
};

} // namespace example
