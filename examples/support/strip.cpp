#include "strip.hpp"

#include "check.hpp"

#include <lamina/grid_io/image.hpp>

#include <glm/common.hpp>

#include <cmath>
#include <cstdio>

namespace example {

void Strip::write(const std::string& file) const {
    const auto count = static_cast<std::uint32_t>(mPictures.size());
    lamina::Image image{mSize * count, mSize, {}};
    for (std::uint32_t y = 0; y < mSize; ++y)
        for (const auto& picture : mPictures)
            for (std::uint32_t x = 0; x < mSize; ++x) {
                const glm::vec3& color = picture[std::size_t{mSize - 1 - y} * mSize + x];
                for (int channel = 0; channel < 3; ++channel)
                    image.rgba.push_back(static_cast<std::uint8_t>(
                        255.0f * std::pow(glm::clamp(color[channel], 0.0f, 1.0f), 1 / 2.2f) +
                        0.5f));
                image.rgba.push_back(255);
            }
    check(lamina::writePng(file, image));
    std::printf("%s\n", file.c_str());
}

} // namespace example
