#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace lamina::test {

/// A NumPy array of uint8 and three dimensions, read without the library's reader.
struct NpyArray {
    glm::uvec3 counts{0}; ///< NX, NY, NZ: the shape (NZ, NY, NX) reversed.
    std::vector<std::uint8_t> values;

    /// a[k][j][i] for voxel (i,j,k).
    [[nodiscard]] std::uint8_t at(const glm::uvec3& voxel) const {
        return values[(static_cast<std::size_t>(voxel.z) * counts.y + voxel.y) * counts.x +
                      voxel.x];
    }
    [[nodiscard]] std::uint64_t setCount() const;
};

/// Adds a test failure and returns an empty array if the file is not what it should be.
NpyArray readNpyArray(const std::string& file);

} // namespace lamina::test
