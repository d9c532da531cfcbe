#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace example {

/// Square pictures beside each other.
class Strip {
public:
    /// size: pixels a side.
    explicit Strip(std::uint32_t size)
        : mSize(size) {}

    /// pixels: linear colours, rows from the bottom.
    void add(std::vector<glm::vec3> pixels) { mPictures.push_back(std::move(pixels)); }
    /// As a PNG, and says so.
    void write(const std::string& file) const;

private:
    std::uint32_t mSize;
    std::vector<std::vector<glm::vec3>> mPictures;
};

} // namespace example
