#include <lamina/grid_io/preview.hpp>

#include "grid_io/preview_scene.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace lamina {
namespace {

constexpr std::uint32_t kMostPixels = 16384;

bool isDirection(const glm::dvec3& v) {
    const double squared = v.x * v.x + v.y * v.y + v.z * v.z;
    return std::isfinite(squared) && squared > 0.0;
}

bool isColor(const glm::vec3& c) {
    return c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1 && c.z >= 0 && c.z <= 1;
}

Result<void> validate(const PreviewDesc& desc) {
    const auto invalid = [](const std::string& expected, const std::string& found) {
        return Error{ErrorCode::InvalidArgument,
                     "preview: expected " + expected + ", found " + found};
    };
    if (desc.width < 1 || desc.height < 1 || desc.width > kMostPixels || desc.height > kMostPixels)
        return invalid("a picture of 1 to 16384 pixels a side",
                       std::to_string(desc.width) + " x " + std::to_string(desc.height));
    if (!isDirection(desc.viewDirection) || !isDirection(desc.up))
        return invalid("finite directions of view and up", "one of length 0 or not finite");
    if (!(desc.fieldOfView > 0.0 && desc.fieldOfView < 3.14))
        return invalid("a field of view in (0, pi)", std::to_string(desc.fieldOfView));
    if (!(desc.margin >= 0.0 && desc.margin <= 0.9))
        return invalid("a margin in [0, 0.9]", std::to_string(desc.margin));
    if (desc.samplesPerPixel < 1 || desc.samplesPerPixel > 4096)
        return invalid("1 to 4096 samples per pixel", std::to_string(desc.samplesPerPixel));
    if (!isColor(desc.lowColor) || !isColor(desc.highColor) || !isColor(desc.backgroundTop) ||
        !isColor(desc.backgroundBottom))
        return invalid("colours in [0,1]", "a component outside");
    return {};
}

void store(const glm::vec4& premultiplied, std::uint8_t* rgba) {
    const float alpha = std::clamp(premultiplied.a, 0.0f, 1.0f);
    const glm::vec3 linear = alpha > 0.0f ? glm::vec3(premultiplied) / alpha : glm::vec3(0.0f);
    const glm::vec3 color = detail::srgbFromLinear(glm::clamp(linear, 0.0f, 1.0f));
    for (int i = 0; i < 3; ++i)
        rgba[i] = static_cast<std::uint8_t>(std::lround(color[i] * 255.0f));
    rgba[3] = static_cast<std::uint8_t>(std::lround(alpha * 255.0f));
}

/// Draws in two passes: a few samples everywhere, then the rest where a voxel, its shadow or a
/// neighbour of either was found. Pixels that no sample of a 3 x 3 block touches are background.
class Renderer {
public:
    Renderer(const detail::PreviewScene& scene, const PreviewDesc& desc,
             const ProgressCallback& progress)
        : mScene(scene)
        , mDesc(desc)
        , mProgress(progress)
        , mDraftSamples(std::max(1u, desc.samplesPerPixel / 4))
        , mSums(std::size_t{desc.width} * desc.height)
        , mImage{desc.width, desc.height, {}} {
        mImage.rgba.resize(4 * mSums.size());
    }

    /// Errors: Cancelled.
    Result<Image> run() {
        if (!forEachRow(0.0, 0.3, [this](std::uint32_t y) { draftRow(y); }) ||
            !forEachRow(0.3, 1.0, [this](std::uint32_t y) { finishRow(y); }))
            return Error{ErrorCode::Cancelled, "preview: cancelled by the progress callback"};
        return std::move(mImage);
    }

private:
    /// Did it go to the end?
    template<class Work>
    bool forEachRow(double progressBegin, double progressEnd, const Work& work) {
        std::atomic<std::uint32_t> next{0};
        std::atomic<bool> isCancelled{false};
        const auto draw = [&](bool reports) {
            // At most about a hundred calls of the callback a pass, however tall the picture.
            const std::uint32_t step = mDesc.height / 100 + 1;
            std::uint32_t reported = 0;
            for (std::uint32_t y; !isCancelled && (y = next++) < mDesc.height;) {
                work(y);
                if (reports && mProgress && y + 1 >= reported + step) {
                    reported = y + 1;
                    if (!mProgress(progressBegin +
                                   (progressEnd - progressBegin) * reported / mDesc.height))
                        isCancelled = true;
                }
            }
        };
        const std::uint32_t wanted =
            mDesc.threads != 0 ? mDesc.threads : std::max(1u, std::thread::hardware_concurrency());
        std::vector<std::jthread> helpers;
        try {
            while (helpers.size() + 1 < std::min(wanted, mDesc.height))
                helpers.emplace_back(draw, false);
        } catch (const std::system_error&) {
            // The system has no more threads to give: those there are draw the picture.
        }
        draw(true);
        helpers.clear();
        return !isCancelled && (!mProgress || mProgress(progressEnd));
    }

    void draftRow(std::uint32_t y) {
        for (std::uint32_t x = 0; x < mDesc.width; ++x)
            sum(x, y) = mScene.samples(x, y, 0, mDraftSamples);
    }

    void finishRow(std::uint32_t y) {
        std::uint8_t* rgba = mImage.rgba.data() + std::size_t{4} * mDesc.width * y;
        const glm::vec4 background = mScene.background(y);
        for (std::uint32_t x = 0; x < mDesc.width; ++x, rgba += 4) {
            glm::vec4 color(0.0f);
            if (isTouched(x, y))
                color = (sum(x, y) + mScene.samples(x, y, mDraftSamples, mDesc.samplesPerPixel)) /
                        static_cast<float>(mDesc.samplesPerPixel);
            store(color + (1.0f - color.a) * background, rgba);
        }
    }

    bool isTouched(std::uint32_t x, std::uint32_t y) {
        for (std::uint32_t v = y - (y > 0); v <= std::min(y + 1, mDesc.height - 1); ++v)
            for (std::uint32_t u = x - (x > 0); u <= std::min(x + 1, mDesc.width - 1); ++u)
                if (sum(u, v).a > 0.0f)
                    return true;
        return false;
    }

    glm::vec4& sum(std::uint32_t x, std::uint32_t y) {
        return mSums[std::size_t{mDesc.width} * y + x];
    }

    const detail::PreviewScene& mScene;
    const PreviewDesc& mDesc;
    const ProgressCallback& mProgress;
    std::uint32_t mDraftSamples;
    std::vector<glm::vec4> mSums; ///< Of the draft's samples; only read in the second pass.
    Image mImage;
};

} // namespace

Result<Image> renderPreview(const BitGrid& grid, const PreviewDesc& desc,
                            const ProgressCallback& progress) {
    if (auto valid = validate(desc); !valid)
        return valid.error();
    const auto voxels = detail::BoxVoxels::create(grid, desc.attributes);
    if (!voxels)
        return Error{voxels.error().code, "preview: " + voxels.error().text};
    try {
        const detail::PreviewScene scene(*voxels, desc);
        return Renderer(scene, desc, progress).run();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::OutOfMemory,
                     "preview: expected memory for a picture of " + std::to_string(desc.width) +
                         " x " + std::to_string(desc.height) + " pixels of " +
                         grid.transform().describe() + ", found too little"};
    }
}

} // namespace lamina
