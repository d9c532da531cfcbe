// 1024 slices in one pass of the geometry, in both stores, and grids split by facing and class.

#include "gl/support/gl_test.hpp"
#include "gl/support/test_meshes.hpp"
#include "gl/support/voxelize.hpp"

#include <lamina/voxelize/voxelizer.hpp>

#include <reference/crossings.hpp>
#include <reference/sampled.hpp>
#include <reference/shapes.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <gmock/gmock.h>

#include <array>

namespace lamina {
namespace {

namespace ref = reference;
using testing::AllOf;
using testing::HasSubstr;

const TriangleMesh kKnot = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 64, 12);

GridTransform boxGrid(const glm::uvec3& size) {
    return GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, size).value();
}

GridTransform perspectiveGrid(const glm::uvec3& size, double near = 1.2, double far = 4.9) {
    const glm::dmat4 view = glm::lookAt(glm::dvec3(1.1, 1.7, 2.3), glm::dvec3(0.1, 0.0, -0.1),
                                        glm::dvec3(0.1, 1.0, 0.0));
    return GridTransform::camera(
               GridCamera::perspective(view, 0.9, double(size.x) / size.y, near, far), size)
        .value();
}

class MrtSlicemapGlTest : public test::GlTest {
protected:
    /// Primitives that reach the rasterizer's side of the geometry stage during `call`.
    template<class Call>
    std::uint64_t primitivesOf(Call&& call) {
        GLuint query = 0;
        gl().CreateQueries(GL_PRIMITIVES_GENERATED, 1, &query);
        gl().BeginQuery(GL_PRIMITIVES_GENERATED, query);
        call();
        gl().EndQuery(GL_PRIMITIVES_GENERATED);
        GLuint64 primitives = 0;
        gl().GetQueryObjectui64v(query, GL_QUERY_RESULT, &primitives);
        gl().DeleteQueries(1, &query);
        return primitives;
    }

    struct Call {
        BitGrid bits;
        VoxelizeStats stats;
        std::uint64_t primitives;
    };
    Call voxelize(const VoxelizerDesc& desc, const TriangleMesh& mesh,
                  const GridTransform& transform) {
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        auto voxelizer = Voxelizer::create(device(), desc).value();
        auto grid = VoxelGrid::create(device()).value();
        VoxelizeStats stats;
        const std::uint64_t primitives = primitivesOf([&] {
            stats = voxelizer->voxelize({&source, 1}, transform, grid).value();
        });
        EXPECT_EQ(grid.store(), voxelizer->capabilities().store);
        return {grid.download().value(), stats, primitives};
    }
};

class MrtStoreGlTest : public MrtSlicemapGlTest, public testing::WithParamInterface<VoxelStore> {};
INSTANTIATE_TEST_SUITE_P(Stores, MrtStoreGlTest,
                         testing::Values(VoxelStore::Texture, VoxelStore::Buffer),
                         [](const auto& store) { return std::string(name(store.param)); });

constexpr Coverage kCoverages[] = {Coverage::Sampled, Coverage::Filled, Coverage::Conservative,
                                   Coverage::Solid};

TEST_P(MrtStoreGlTest, EightSlicemapsInOnePassOfTheGeometry) {
    // Inside the grid, so that no pass of the slicemaps can drop a triangle by its columns.
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.5f, 0.2f, 2, 3, 600, 40);
    for (const Coverage coverage : kCoverages)
        for (const GridTransform& transform :
             {boxGrid({160, 120, 1024}), perspectiveGrid({130, 150, 1024})}) {
            const std::string name =
                transform.describe() + ", " + std::string(lamina::name(coverage));
            const Call together =
                voxelize({Backend::MrtSlicemap, coverage, false, GetParam()}, mesh, transform);
            const Call apart = voxelize({Backend::Slicemap, coverage}, mesh, transform);
            EXPECT_TRUE(compare(together.bits, apart.bits)->equal()) << name;
            EXPECT_GT(together.bits.count(), 10000u);
            EXPECT_EQ(together.stats.passes, 1u) << name;
            EXPECT_EQ(apart.stats.passes, 8u) << name;
            // One polygon (a strip of one to five triangles) for each triangle not edge-on, as in a
            // grid of one pass.
            EXPECT_LE(together.primitives, 5 * mesh.triangles.size()) << name;
            EXPECT_GE(together.primitives, mesh.triangles.size() * 9 / 10) << name;
            const Call first = voxelize({Backend::MrtSlicemap, coverage, false, GetParam()}, mesh,
                                        transform.withSlices(128).value());
            EXPECT_EQ(together.primitives, first.primitives) << name;
        }
}

TEST_P(MrtStoreGlTest, SliceCountsAroundWordGroupAndPassEdges) {
    const TriangleMesh mesh = ref::makeIcosphere({0, 0, 0}, 0.97f, 3);
    for (const std::uint32_t slices :
         {1u, 32u, 33u, 127u, 128u, 129u, 384u, 500u, 1023u, 1024u, 1025u, 2048u, 2500u}) {
        const GridTransform transform = boxGrid({37, 23, slices});
        // Of the programs for every number of targets, two coverages' are enough.
        for (const Coverage coverage : {Coverage::Filled, Coverage::Solid}) {
            const Call together =
                voxelize({Backend::MrtSlicemap, coverage, false, GetParam()}, mesh, transform);
            const Call apart = voxelize({Backend::Slicemap, coverage}, mesh, transform);
            EXPECT_TRUE(compare(together.bits, apart.bits)->equal()) << transform.describe();
            EXPECT_EQ(together.stats.passes, (slices + 1023) / 1024);
        }
    }
}

TEST_P(MrtStoreGlTest, SolidTellsOddColumns) {
    // An open box: its lid is missing.
    TriangleMesh mesh = ref::makeBox({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f});
    const VoxelizerDesc desc{Backend::MrtSlicemap, Coverage::Solid, false, GetParam()};
    for (const bool isOpen : {false, true}) {
        if (isOpen)
            std::erase_if(mesh.triangles, [&](const auto& triangle) {
                return mesh.positions[triangle[0]].z > 0 && mesh.positions[triangle[1]].z > 0 &&
                       mesh.positions[triangle[2]].z > 0;
            });
        auto buffers = MeshBuffers::upload(device(), mesh).value();
        const GeometrySource source = buffers.view();
        auto voxelizer = Voxelizer::create(device(), desc).value();
        auto grid = VoxelGrid::create(device()).value();
        // Two passes: the first alone counts crossings.
        ASSERT_TRUE(voxelizer->voxelize({&source, 1}, boxGrid({40, 40, 2000}), grid));
        EXPECT_EQ(voxelizer->downloadSolidReport()->oddColumns, isOpen ? 400u : 0u);
        EXPECT_EQ(grid.download()->count(), isOpen ? 400u * 500 : 400u * 1000);
    }
}

TEST_P(MrtStoreGlTest, AMillionTrianglesAgreeWithTheReference) {
    const TriangleMesh mesh = ref::makeTorusKnot({0, 0, 0}, 0.6f, 0.15f, 3, 5, 8192, 64);
    const GridTransform transform =
        GridTransform::box({{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}}, {512, 512, 1024}).value();
    const Call found =
        voxelize({Backend::MrtSlicemap, Coverage::Sampled, false, GetParam()}, mesh, transform);
    const auto difference = compare(found.bits, ref::sampled(mesh, transform).value()).value();
    // Double rounding alone, at most one voxel in a hundred thousand.
    EXPECT_LE((difference.onlyFirst + difference.onlySecond) * 100000, difference.both);
    EXPECT_EQ(found.stats.passes, 1u);
}

TEST_P(MrtStoreGlTest, AGridIsReusedAndHoldsNothingOfTheLastCall) {
    auto buffers = MeshBuffers::upload(device(), kKnot).value();
    const GeometrySource source = buffers.view();
    auto voxelizer =
        Voxelizer::create(device(), {Backend::MrtSlicemap, Coverage::Filled, false, GetParam()})
            .value();
    auto grid = VoxelGrid::create(device()).value();
    ASSERT_TRUE(voxelizer->voxelize({&source, 1}, boxGrid({40, 40, 700}), grid));
    const std::uint64_t bytes = device().allocatedBytes();
    ASSERT_TRUE(voxelizer->voxelize({}, boxGrid({40, 40, 700}), grid));
    EXPECT_EQ(grid.download()->count(), 0u);
    EXPECT_EQ(device().allocatedBytes(), bytes);
}

TEST_F(MrtSlicemapGlTest, TheStoreIsMeasuredOrAskedFor) {
    const auto measured = Voxelizer::create(device(), {Backend::MrtSlicemap}).value();
    EXPECT_THAT(measured->reason(), HasSubstr("measured to be faster"));
    EXPECT_EQ(Voxelizer::create(device(), {Backend::MrtSlicemap}).value()->capabilities().store,
              measured->capabilities().store);
    EXPECT_EQ(device().allocatedBytes(), 0u);
    for (const VoxelStore store : {VoxelStore::Texture, VoxelStore::Buffer}) {
        const auto asked =
            Voxelizer::create(device(), {Backend::MrtSlicemap, Coverage::Sampled, false, store})
                .value();
        EXPECT_EQ(asked->capabilities().store, store);
        EXPECT_EQ(asked->capabilities().slicesPerPass, 1024u);
    }
    // Without the memory to measure, the texture serves.
    auto small = Device::fromCurrentContext([](const char* name) {
                     return test::context().getProcAddress(name);
                 }).value();
    small.setMemoryBudget(1000);
    EXPECT_EQ(Voxelizer::create(small, {Backend::MrtSlicemap}).value()->capabilities().store,
              VoxelStore::Texture);
}

TEST_F(MrtSlicemapGlTest, RefusalsNameTheNearestThatIsServed) {
    const auto refusal = [&](const VoxelizerDesc& desc) {
        const auto created = Voxelizer::create(device(), desc);
        EXPECT_FALSE(created);
        EXPECT_EQ(created.error().code, ErrorCode::Unsupported);
        return created.error().text;
    };
    EXPECT_THAT(
        refusal({Backend::MrtSlicemap, Coverage::Separating6}),
        AllOf(HasSubstr("found mrt_slicemap"), HasSubstr("overlap"), HasSubstr("conservative")));
    for (const Coverage coverage : {Coverage::Separating6, Coverage::Solid})
        for (const Backend backend :
             {Backend::Automatic, Backend::LocalSlicemap, Backend::MrtSlicemap})
            EXPECT_THAT(refusal({backend, coverage, true}),
                        AllOf(HasSubstr("found " + std::string(name(coverage))),
                              HasSubstr("use coverage conservative or filled"),
                              HasSubstr("overlap")));
    EXPECT_THAT(refusal({Backend::Slicemap, Coverage::Filled, true}),
                HasSubstr("use local_slicemap or mrt_slicemap"));
    EXPECT_THAT(refusal({Backend::Slicemap, Coverage::Filled, false, VoxelStore::Buffer}),
                HasSubstr("or use mrt_slicemap"));
    EXPECT_THAT(refusal({Backend::Overlap, Coverage::Separating6, false, VoxelStore::Texture}),
                HasSubstr("the buffer store, which overlap writes"));
    const auto local = Voxelizer::create(device(), {Backend::Automatic, Coverage::Filled, true});
    EXPECT_EQ(local.value()->backend(), Backend::MrtSlicemap);
    EXPECT_TRUE(local.value()->capabilities().localRanges);
}

TEST_F(MrtSlicemapGlTest, FrontsAndBacksAreToldApartByTheGridsCamera) {
    // A convex body: the camera sees fronts before backs, each column one of both.
    const TriangleMesh mesh = ref::makeIcosphere({0.05f, 0.1f, 0}, 0.7f, 4);
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const glm::mat4 mirror = glm::scale(glm::mat4(1.0f), {-1.0f, 1.0f, 1.0f});
    for (const glm::mat4& model : {glm::mat4(1.0f), mirror})
        for (const GridTransform& transform :
             {GridTransform::box({{-1, -1, -1}, {1, 1, 1}}, {512, 60, 50}, Axis::X).value(),
              boxGrid({60, 50, 512}), perspectiveGrid({60, 50, 512})})
            for (const bool isLocal : {false, true}) {
                const GeometrySource source = buffers.view(model);
                VoxelizerDesc desc{Backend::MrtSlicemap, Coverage::Sampled, isLocal};
                auto voxelizer = Voxelizer::create(device(), desc).value();
                std::vector<VoxelGrid> grids;
                for (int i = 0; i < 2; ++i)
                    grids.push_back(VoxelGrid::create(device()).value());
                VoxelizeOptions options;
                options.split = Split::Facing;
                const auto stats =
                    voxelizer->voxelizeWith({&source, 1}, transform, options, grids).value();
                EXPECT_EQ(stats.passes, isLocal ? 2u : 1u);
                EXPECT_EQ(grids[0].rangeTexture(), grids[1].rangeTexture());
                EXPECT_EQ(grids[0].hasLocalRanges(), isLocal);
                const BitGrid front = grids[0].download().value();
                const BitGrid back = grids[1].download().value();
                std::size_t both = 0;
                for (std::uint32_t y = 0; y < 50; ++y)
                    for (std::uint32_t x = 0; x < 60; ++x) {
                        const std::uint32_t fronts = front.countNearer({x, y}, 512);
                        // Where the silhouette runs through the column the slices may coincide.
                        ASSERT_LE(fronts, 1u);
                        ASSERT_EQ(fronts, back.countNearer({x, y}, 512));
                        for (std::uint32_t k = 0; k < 512 && fronts == 1; ++k)
                            if (front.test({x, y, k})) {
                                ASSERT_EQ(back.countNearer({x, y}, k), 0u);
                                ++both;
                            }
                    }
                EXPECT_GT(both, 300u);
                // Together they are the unsplit grid.
                BitGrid sum = front;
                for (std::size_t i = 0; i < sum.words().size(); ++i)
                    sum.words()[i] |= back.words()[i];
                const BitGrid whole = test::voxelize(device(), desc, {&source, 1}, transform);
                EXPECT_TRUE(compare(sum, whole)->equal());
                EXPECT_TRUE(std::ranges::equal(front.ranges(), whole.ranges()));
            }
}

TEST_F(MrtSlicemapGlTest, FacesAroundTheEyeKeepTheirSide) {
    // From inside a closed body all that is seen shows its back.
    const TriangleMesh mesh = ref::makeBox({-1, -1, -1}, {1, 1, 1});
    const glm::dmat4 view =
        glm::lookAt(glm::dvec3(0.05, 0.1, 0.2), glm::dvec3(0.7, 0.2, -0.4), glm::dvec3(0, 1, 0));
    const GridTransform transform =
        GridTransform::camera(GridCamera::perspective(view, 1.9, 1.0, 0.1, 3.0), {40, 40, 128})
            .value();
    auto buffers = MeshBuffers::upload(device(), mesh).value();
    const GeometrySource source = buffers.view();
    auto voxelizer = Voxelizer::create(device(), {Backend::Slicemap}).value();
    std::vector<VoxelGrid> grids;
    for (int i = 0; i < 2; ++i)
        grids.push_back(VoxelGrid::create(device()).value());
    VoxelizeOptions options;
    options.split = Split::Facing;
    const auto stats = voxelizer->voxelizeWith({&source, 1}, transform, options, grids).value();
    EXPECT_EQ(stats.passes, 1u);
    EXPECT_EQ(grids[0].download()->count(), 0u);
    EXPECT_EQ(grids[1].download()->count(), 1600u);
}

TEST_F(MrtSlicemapGlTest, ThreeLeafColoursInOnePass) {
    // Materials 0 to 4 of classes 2, 0, 1, 1 (fronts alone), 0; ids beyond use the last.
    std::vector<Material> materials(5);
    const std::uint32_t classes[] = {2, 0, 1, 1, 0};
    for (std::size_t i = 0; i < 5; ++i)
        materials[i].colorClass = classes[i];
    materials[3].orientation = OrientationRule::FrontFaces;
    const std::uint32_t ids[] = {0, 1, 2, 3, 4, 77};
    for (const std::uint32_t slices : {128u, 300u, 512u}) {
        const GridTransform transform = perspectiveGrid({70, 60, slices});
        std::vector<MeshBuffers> buffers;
        std::vector<GeometrySource> sources;
        std::vector<BitGrid> expected(3, BitGrid::create(transform).value());
        for (std::size_t i = 0; i < 6; ++i) {
            const TriangleMesh mesh = ref::makeTriangleSoup({{-1, -1, -1}, {1, 1, 1}}, 40, 0.5f,
                                                            static_cast<std::uint32_t>(i));
            buffers.push_back(MeshBuffers::upload(device(), mesh).value());
            MeshView view = buffers.back().view();
            view.materialId = ids[i];
            sources.emplace_back(view);
            std::vector<VoxelGrid> sides;
            for (int side = 0; side < 2; ++side)
                sides.push_back(VoxelGrid::create(device()).value());
            VoxelizeOptions facing;
            facing.split = Split::Facing;
            ASSERT_TRUE(Voxelizer::create(device(), {Backend::Slicemap})
                            .value()
                            ->voxelizeWith({&sources.back(), 1}, transform, facing, sides));
            for (int side = 0; side < (ids[i] == 3 ? 1 : 2); ++side)
                sides[static_cast<std::size_t>(side)].download()->forEachSet(
                    [&](const glm::uvec3& voxel) {
                        expected[materials[std::min<std::size_t>(ids[i], 4)].colorClass].set(voxel);
                    });
        }
        auto voxelizer = Voxelizer::create(device(), {Backend::MrtSlicemap}).value();
        std::vector<VoxelGrid> grids;
        for (int i = 0; i < 3; ++i)
            grids.push_back(VoxelGrid::create(device()).value());
        VoxelizeOptions options;
        options.split = Split::ColorClass;
        options.materials = materials;
        const auto stats = voxelizer->voxelizeWith(sources, transform, options, grids).value();
        // Two groups of three grids are six targets.
        EXPECT_EQ(stats.passes, (slices + 255) / 256);
        EXPECT_EQ(stats.gridBytes, 3 * grids[0].gpuBytes());
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(grids[i].store(), VoxelStore::Texture);
            EXPECT_TRUE(compare(grids[i].download().value(), expected[i])->equal()) << i;
            EXPECT_GT(expected[i].count(), 100u);
        }
    }
}

TEST_F(MrtSlicemapGlTest, ADrawSourcesMaterialsChooseTheClass) {
    GLuint vertexArray = 0;
    gl().CreateVertexArrays(1, &vertexArray);
    // Eight quads across x, each of its own material.
    DrawSource source;
    source.vertexShader = R"(
        LaminaVertex laminaVertex() {
            int quad = gl_VertexID / 6;
            int corner = int[](0, 1, 2, 2, 1, 3)[gl_VertexID % 6];
            vec2 place = vec2(quad + (corner & 1), 8 * (corner >> 1)) / 8.0;
            return LaminaVertex(vec3(place, 0.3), vec3(0.0), uint(quad));
        })";
    source.draw = [&](const DrawContext&) {
        gl().BindVertexArray(vertexArray);
        gl().DrawArrays(GL_TRIANGLES, 0, 48);
    };
    std::vector<Material> materials(8);
    for (std::uint32_t i = 0; i < 8; ++i)
        materials[i].colorClass = 7 - i;
    std::vector<VoxelGrid> grids;
    for (int i = 0; i < 8; ++i)
        grids.push_back(VoxelGrid::create(device()).value());
    VoxelizeOptions options;
    options.split = Split::ColorClass;
    options.materials = materials;
    const GeometrySource sources[] = {source};
    const GridTransform transform = GridTransform::box({{0, 0, 0}, {1, 1, 1}}, {8, 4, 128}).value();
    auto voxelizer =
        Voxelizer::create(device(), {Backend::MrtSlicemap, Coverage::Sampled, true}).value();
    EXPECT_EQ(voxelizer->voxelizeWith(sources, transform, options, grids)->passes, 2u);
    for (std::uint32_t i = 0; i < 8; ++i) {
        const BitGrid bits = grids[i].download().value();
        EXPECT_EQ(bits.count(), 4u);
        for (std::uint32_t y = 0; y < 4; ++y)
            EXPECT_EQ(bits.countNearer({7 - i, y}, 128), 1u);
    }
    gl().DeleteVertexArrays(1, &vertexArray);
}

TEST_F(MrtSlicemapGlTest, WrongOptionsAreErrorsThatChangeNothing) {
    auto voxelizer = Voxelizer::create(device(), {Backend::Slicemap}).value();
    std::vector<VoxelGrid> grids;
    for (int i = 0; i < 9; ++i)
        grids.push_back(VoxelGrid::create(device()).value());
    const GridTransform transform = boxGrid({8, 8, 128});
    const auto error = [&](const VoxelizeOptions& options, std::size_t count) {
        const auto stats =
            voxelizer->voxelizeWith({}, transform, options, std::span(grids).first(count));
        EXPECT_FALSE(stats);
        for (const VoxelGrid& grid : grids)
            EXPECT_EQ(grid.transform(), nullptr);
        return stats ? std::string() : stats.error().text;
    };
    EXPECT_THAT(error({}, 2), HasSubstr("expected 1 grid for this split, found 2"));
    EXPECT_THAT(error({.split = Split::Facing}, 1), HasSubstr("expected 2 grids"));
    const std::vector<Material> materials{Material{}, Material{.colorClass = 3}};
    EXPECT_THAT(error({.split = Split::ColorClass, .materials = materials}, 9),
                HasSubstr("expected 1 to 8 grids"));
    EXPECT_THAT(error({.split = Split::ColorClass, .materials = materials}, 3),
                HasSubstr("below the number of grids, 3, found 3 in material 1"));
    EXPECT_THAT(error({.split = Split::ColorClass}, 3), HasSubstr("1 to 4096 materials"));
    const GeometrySource bounds[] = {DrawSource{}};
    EXPECT_THAT(error({.bounds = bounds}, 1), HasSubstr("create the voxelizer with localRanges"));

    auto overlap = Voxelizer::create(device(), {.coverage = Coverage::Separating6}).value();
    const auto refused = overlap->voxelizeWith({}, transform, {}, {grids.data(), 1});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(refused.error().text, HasSubstr("found overlap"));

    auto solid = Voxelizer::create(device(), {Backend::MrtSlicemap, Coverage::Solid}).value();
    const auto unsplit =
        solid->voxelizeWith({}, transform, {.split = Split::Facing}, std::span(grids).first(2));
    ASSERT_FALSE(unsplit);
    EXPECT_EQ(unsplit.error().code, ErrorCode::Unsupported);
    EXPECT_THAT(unsplit.error().text, HasSubstr("found solid; use coverage conservative"));

    // Memory for one of two grids: neither changes.
    device().setMemoryBudget(device().allocatedBytes() + 8 * 8 * 16 + 20);
    VoxelizeOptions facing;
    facing.split = Split::Facing;
    const auto failed = voxelizer->voxelizeWith({}, transform, facing, std::span(grids).first(2));
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ErrorCode::OutOfMemory);
    EXPECT_EQ(grids[0].transform(), nullptr);
    EXPECT_EQ(grids[1].transform(), nullptr);
}

} // namespace
} // namespace lamina
