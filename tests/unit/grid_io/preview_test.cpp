#include "grid_fixture.hpp"

#include <lamina/grid_io/preview.hpp>

#include <gmock/gmock.h>

#include <cmath>

namespace lamina {
namespace {

using testing::HasSubstr;

/// Voxels alone, opaque on nothing: the alpha channel is the coverage.
PreviewDesc silhouetteDesc(std::uint32_t width, std::uint32_t height, const glm::dvec3& direction) {
    PreviewDesc desc;
    desc.width = width;
    desc.height = height;
    desc.viewDirection = direction;
    desc.margin = 0.2;
    desc.samplesPerPixel = 16;
    desc.transparentBackground = true;
    desc.ground = false;
    return desc;
}

BitGrid fullGrid(const Box3& box, const glm::uvec3& counts, Axis axis = Axis::Z) {
    BitGrid grid = test::emptyGrid(box, counts, axis);
    for (std::uint32_t k = 0; k < counts.z; ++k)
        for (std::uint32_t j = 0; j < counts.y; ++j)
            for (std::uint32_t i = 0; i < counts.x; ++i)
                test::setWorld(grid, counts, {i, j, k});
    return grid;
}

Image rendered(const BitGrid& grid, const PreviewDesc& desc) {
    auto image = renderPreview(grid, desc);
    if (!image) {
        ADD_FAILURE() << image.error().text;
        return {};
    }
    return std::move(*image);
}

/// The alpha channel is 255 inside the rectangle and 0 outside, a pixel around its border aside.
void expectRectangle(const Image& image, double left, double top, double right, double bottom) {
    double covered = 0.0;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const int alpha = image.pixel(x, y)[3];
            covered += alpha / 255.0;
            const bool inside = x >= left + 1 && x + 2 <= right && y >= top + 1 && y + 2 <= bottom;
            const bool outside = x + 2 <= left || x >= right + 1 || y + 2 <= top || y >= bottom + 1;
            ASSERT_TRUE(!inside || alpha == 255) << x << ", " << y << ": " << alpha;
            ASSERT_TRUE(!outside || alpha == 0) << x << ", " << y << ": " << alpha;
        }
    // A pixel's alpha is its covered share: the sum is the area, to a tenth of a border pixel.
    const double area = (right - left) * (bottom - top);
    EXPECT_NEAR(covered, area, 0.1 * 2.0 * (right - left + bottom - top));
}

TEST(Preview, EmptyGridIsBackground) {
    const BitGrid grid = test::emptyGrid({{0, 0, 0}, {1, 1, 1}}, {8, 8, 8}, Axis::Z);
    PreviewDesc desc;
    desc.width = 30;
    desc.height = 256;
    desc.backgroundTop = {1.0f, 0.5f, 0.0f};
    desc.backgroundBottom = {1.0f, 0.5f, 1.0f};
    const Image image = rendered(grid, desc);
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            ASSERT_EQ(image.pixel(x, y)[0], 255);
            ASSERT_EQ(image.pixel(x, y)[1], 128);
            ASSERT_EQ(image.pixel(x, y)[2], image.pixel(0, y)[2]);
            ASSERT_EQ(image.pixel(x, y)[3], 255);
        }
    EXPECT_LE(image.pixel(0, 0)[2], 10);
    EXPECT_GE(image.pixel(0, 255)[2], 254);
    // Half of the light is 188 of 255 in sRGB.
    EXPECT_NEAR(image.pixel(0, 128)[2], 188, 1);
}

TEST(Preview, EmptyGridIsNothingOnATransparentBackground) {
    const BitGrid grid = test::emptyGrid({{0, 0, 0}, {1, 1, 1}}, {8, 8, 8}, Axis::Z);
    PreviewDesc desc = silhouetteDesc(20, 20, {-1, -1, -1});
    desc.ground = true;
    EXPECT_THAT(rendered(grid, desc).rgba, testing::Each(0));
}

TEST(Preview, AFaceSeenStraightOnFillsTheFrame) {
    // The near face of the box bounds the view: it takes the middle 80 % of the picture.
    const glm::dvec3 directions[] = {{-1, 0, 0}, {1, 0, 0},  {0, 0, -3},
                                     {0, 0, 1},  {0, -1, 0}, {0, 0.5, 0}};
    for (const glm::dvec3& direction : directions)
        expectRectangle(rendered(fullGrid({{5, 5, 5}, {7, 7, 7}}, {3, 3, 3}),
                                 silhouetteDesc(200, 200, direction)),
                        20, 20, 180, 180);
}

TEST(Preview, VoxelsNeedNotBeCubes) {
    // Seen along -z the box is 4 wide and 1 high; in a picture 2 wide and 1 high the width binds.
    const BitGrid grid = fullGrid({{0, 0, 0}, {4, 1, 1}}, {2, 3, 5});
    expectRectangle(rendered(grid, silhouetteDesc(200, 100, {0, 0, -1})), 20, 30, 180, 70);
}

TEST(Preview, ASingleVoxelStandsWhereItProjects) {
    // In the near layer of a 4 x 4 x 4 grid seen along -x, up y, so that z runs to the left. The
    // voxel touches the view's axis from above and from the right: its sides are seen edge on, and
    // its silhouette is its near face, which lies in the plane that fills 160 of the 200 pixels.
    BitGrid grid = test::emptyGrid({{0, 0, 0}, {4, 4, 4}}, {4, 4, 4}, Axis::Y);
    test::setWorld(grid, {4, 4, 4}, {3, 2, 1});
    expectRectangle(rendered(grid, silhouetteDesc(200, 200, {-1, 0, 0})), 100, 60, 140, 100);
}

TEST(Preview, APlaneFacingTheViewIsASquareAndEdgeOnALine) {
    BitGrid grid = test::emptyGrid({{0, 0, 0}, {40, 40, 40}}, {40, 40, 40}, Axis::Z);
    for (std::uint32_t k = 0; k < 40; ++k)
        for (std::uint32_t j = 0; j < 40; ++j)
            test::setWorld(grid, {40, 40, 40}, {39, j, k});
    expectRectangle(rendered(grid, silhouetteDesc(200, 200, {-1, 0, 0})), 20, 20, 180, 180);
    // Edge on, its nearest part is a voxel wide and as high as the frame, at the side where x is
    // large.
    const Image edge = rendered(grid, silhouetteDesc(200, 200, {0, 0, -1}));
    EXPECT_EQ(edge.pixel(177, 100)[3], 255);
    EXPECT_EQ(edge.pixel(181, 100)[3], 0);
    EXPECT_EQ(edge.pixel(150, 100)[3], 0);
}

TEST(Preview, AnyViewKeepsTheBoxInsideTheMargin) {
    const BitGrid grid = fullGrid({{-3, 1, 2}, {2, 3, 5}}, {5, 2, 3});
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int n = 0; n < 30; ++n) {
        PreviewDesc desc =
            silhouetteDesc(150, 100, {normal(random), normal(random), normal(random)});
        desc.up = {normal(random), normal(random), normal(random)};
        desc.fieldOfView = n % 2 ? 0.3 : 1.4;
        const Image image = rendered(grid, desc);
        double left = 150, right = 0, top = 100, bottom = 0;
        for (std::uint32_t y = 0; y < 100; ++y)
            for (std::uint32_t x = 0; x < 150; ++x)
                if (image.pixel(x, y)[3] > 0) {
                    left = std::min<double>(left, x);
                    right = std::max<double>(right, x + 1);
                    top = std::min<double>(top, y);
                    bottom = std::max<double>(bottom, y + 1);
                }
        // 10 % of the picture stays free on each side, and one pair of sides is reached (a corner's
        // last pixel may fall between samples).
        EXPECT_GE(left, 15.0);
        EXPECT_LE(right, 135.0);
        EXPECT_GE(top, 10.0);
        EXPECT_LE(bottom, 90.0);
        EXPECT_TRUE((left <= 17 && right >= 133) || (top <= 12 && bottom >= 88))
            << left << " " << right << " " << top << " " << bottom;
    }
}

TEST(Preview, UpIsUp) {
    BitGrid grid = test::emptyGrid({{0, 0, 0}, {4, 4, 4}}, {4, 4, 4}, Axis::X);
    test::setWorld(grid, {4, 4, 4}, {3, 1, 3}); // Highest along z alone.
    PreviewDesc desc = silhouetteDesc(100, 100, {-1, 0, 0});
    const auto centre = [&] {
        const Image image = rendered(grid, desc);
        glm::dvec2 sum(0.0);
        double count = 0;
        for (std::uint32_t y = 0; y < 100; ++y)
            for (std::uint32_t x = 0; x < 100; ++x)
                if (image.pixel(x, y)[3] > 128) {
                    sum += glm::dvec2(x, y);
                    ++count;
                }
        return sum / count;
    };
    desc.up = {0, 0, 1};
    EXPECT_LT(centre().y, 40);
    desc.up = {0, 0, -1};
    EXPECT_GT(centre().y, 60);
    desc.up = {0, 1, 0};
    EXPECT_LT(centre().x, 40); // z to the left.
    EXPECT_GT(centre().y, 50);
}

TEST(Preview, IsTheSameForEveryAxisAndThreadCount) {
    const glm::uvec3 counts(20, 13, 37);
    const Box3 box = test::boxOf(counts, {0.5, 1.0, 0.25});
    PreviewDesc desc;
    desc.width = 60;
    desc.height = 50;
    desc.samplesPerPixel = 5;
    desc.threads = 1;
    const Image first = rendered(test::randomGrid(box, counts, Axis::Z), desc);
    desc.threads = 3;
    EXPECT_EQ(rendered(test::randomGrid(box, counts, Axis::X), desc).rgba, first.rgba);
    desc.threads = 0;
    EXPECT_EQ(rendered(test::randomGrid(box, counts, Axis::Y), desc).rgba, first.rgba);
}

TEST(Preview, ColoursComeFromTheDescription) {
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {8, 8, 8});
    PreviewDesc desc = silhouetteDesc(60, 60, {-1, -0.2, 0});
    desc.lowColor = {0, 1, 0};
    desc.highColor = {0, 0, 1};
    const Image image = rendered(grid, desc);
    const auto top = image.pixel(30, 20), bottom = image.pixel(30, 50);
    EXPECT_EQ(top[0], 0);
    EXPECT_GT(top[2], top[1] + 50);
    EXPECT_EQ(bottom[0], 0);
    EXPECT_GT(bottom[1], bottom[2] + 50);
}

TEST(Preview, AVoxelAboveShadesTheFloor) {
    // The sun stands high, behind the viewer's left shoulder; a roof over the whole floor hides it.
    const glm::uvec3 counts(16, 16, 16);
    const auto floorLight = [&](bool roof) {
        BitGrid grid = test::emptyGrid({{0, 0, 0}, {16, 16, 16}}, counts, Axis::Z);
        for (std::uint32_t k = 0; k < 16; ++k)
            for (std::uint32_t i = 0; i < 16; ++i) {
                test::setWorld(grid, counts, {i, 0, k});
                if (roof)
                    test::setWorld(grid, counts, {i, 3, k});
            }
        PreviewDesc desc = silhouetteDesc(100, 100, {0, -0.05, -1});
        desc.up = {0, 1, 0};
        desc.lowColor = desc.highColor = {0.8f, 0.8f, 0.8f};
        const Image image = rendered(grid, desc);
        // The lowest rows show the floor's front; above them its upper side, seen at a slant.
        double light = 0.0;
        for (std::uint32_t x = 40; x < 60; ++x)
            light += image.pixel(x, 83)[1];
        return light / 20;
    };
    EXPECT_GT(floorLight(false), 60);
    EXPECT_LT(floorLight(true), 0.8 * floorLight(false));
}

TEST(Preview, TheGroundCarriesAShadow) {
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4});
    PreviewDesc desc = silhouetteDesc(80, 80, {-0.6, -0.5, -0.6});
    desc.margin = 0.5;
    const auto faintPixels = [&] {
        const Image image = rendered(grid, desc);
        int count = 0;
        for (std::size_t i = 3; i < image.rgba.size(); i += 4)
            count += image.rgba[i] > 40 && image.rgba[i] < 250;
        return count;
    };
    const int outline = faintPixels();
    desc.ground = true;
    EXPECT_GT(faintPixels(), outline + 100);
    desc.viewDirection = {-0.6, 0.5, -0.6}; // From below there is no ground to see.
    EXPECT_LT(faintPixels(), outline + 50);
}

TEST(Preview, JointsShowWhereVoxelsAreLarge) {
    // A flat wall whose joints stand at pixels 48, 80 and 112: the row crosses the middle one.
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4});
    PreviewDesc desc = silhouetteDesc(160, 160, {-1, 0, 0});
    desc.lowColor = desc.highColor = {0.6f, 0.6f, 0.6f};
    desc.samplesPerPixel = 64;
    const auto contrast = [&] {
        const Image image = rendered(grid, desc);
        int least = 255, most = 0;
        for (std::uint32_t x = 66; x < 94; ++x) {
            least = std::min<int>(least, image.pixel(x, 96)[1]);
            most = std::max<int>(most, image.pixel(x, 96)[1]);
        }
        return most - least;
    };
    const int with = contrast();
    desc.edges = false;
    EXPECT_GT(with, contrast() + 8);
}

TEST(Preview, ReportsProgressUpToOne) {
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4});
    std::vector<double> fractions;
    PreviewDesc desc;
    desc.width = 8;
    desc.height = 700;
    desc.samplesPerPixel = 1;
    ASSERT_TRUE(renderPreview(grid, desc, [&](double fraction) {
        fractions.push_back(fraction);
        return true;
    }));
    ASSERT_FALSE(fractions.empty());
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.back(), 1.0);
    EXPECT_LT(fractions.size(), 400u);
}

TEST(Preview, IsCancelledInBothPasses) {
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4});
    PreviewDesc desc;
    desc.width = 8;
    desc.height = 700;
    desc.samplesPerPixel = 1;
    for (const double end : {0.0, 0.1, 0.3, 0.7, 1.0}) {
        bool wasTold = false;
        const auto image = renderPreview(grid, desc, [&](double fraction) {
            EXPECT_FALSE(wasTold) << "asked again";
            wasTold = fraction >= end;
            return !wasTold;
        });
        ASSERT_FALSE(image) << end;
        EXPECT_EQ(image.error().code, ErrorCode::Cancelled);
        EXPECT_THAT(image.error().text, HasSubstr("cancelled by the progress callback"));
    }
}

TEST(Preview, NamesArgumentsOutOfRange) {
    const BitGrid grid = fullGrid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2});
    struct Case {
        void (*spoil)(PreviewDesc&);
        const char* text;
    };
    const Case cases[] = {
        {[](PreviewDesc& d) { d.width = 0; }, "found 0 x 1024"},
        {[](PreviewDesc& d) { d.height = 16385; }, "1 to 16384 pixels a side"},
        {[](PreviewDesc& d) {
             d.viewDirection = {0, 0, 0};
         },
         "directions of view and up"},
        {[](PreviewDesc& d) {
             d.up = {NAN, 0, 1};
         },
         "directions of view and up"},
        {[](PreviewDesc& d) { d.fieldOfView = 4.0; }, "field of view in (0, pi)"},
        {[](PreviewDesc& d) { d.margin = 1.0; }, "margin in [0, 0.9]"},
        {[](PreviewDesc& d) { d.samplesPerPixel = 0; }, "1 to 4096 samples"},
        {[](PreviewDesc& d) { d.highColor.g = 1.5f; }, "colours in [0,1]"},
    };
    for (const Case& c : cases) {
        PreviewDesc desc;
        c.spoil(desc);
        const auto image = renderPreview(grid, desc);
        ASSERT_FALSE(image) << c.text;
        EXPECT_EQ(image.error().code, ErrorCode::InvalidArgument);
        EXPECT_THAT(image.error().text, HasSubstr(c.text));
    }
    const auto camera =
        renderPreview(*BitGrid::create(*GridTransform::camera(GridCamera(), {4, 4, 4})));
    ASSERT_FALSE(camera);
    EXPECT_EQ(camera.error().code, ErrorCode::Unsupported);
}

} // namespace
} // namespace lamina
