#include "support/mesh_files.hpp"
#include "support/npy_array.hpp"
#include "support/temporary_folder.hpp"
#include "support/tool_process.hpp"

#include <lamina/mesh_io/mesh_file.hpp>
#include <lamina/voxelize/voxelizer.hpp>

#include <reference/crossings.hpp>
#include <reference/filled.hpp>
#include <reference/overlap.hpp>
#include <reference/sampled.hpp>
#include <reference/shapes.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>

namespace lamina::test {
namespace {

constexpr std::array kAxisNames{"x", "y", "z"};

/// Runs the tool, expects success and returns the voxels of `out`.
NpyArray voxelsOf(std::vector<std::string> arguments, const std::string& out) {
    arguments.insert(arguments.end(), {"-o", out});
    const ToolResult result = runTool(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.err;
    return result.exitCode == 0 ? readNpyArray(out) : NpyArray{};
}

/// The voxels of a reference grid, looked up by the world position of each voxel's centre.
bool isSetAt(const BitGrid& grid, const glm::uvec3& voxel) {
    const Box3& box = grid.transform().boxBounds();
    const glm::uvec3 axes = boxGridAxes(*grid.transform().boxAxis());
    glm::dvec3 counts;
    for (int i = 0; i < 3; ++i)
        counts[axes[i]] = grid.size()[i];
    return grid.at(box.min + (glm::dvec3(voxel) + 0.5) / counts * box.size());
}

/// Voxels for which `isRight(voxel, value in the array)` is false.
std::uint64_t wrongVoxels(const NpyArray& array,
                          const std::function<bool(const glm::uvec3&, bool)>& isRight) {
    std::uint64_t wrong = 0;
    for (std::uint32_t k = 0; k < array.counts.z; ++k)
        for (std::uint32_t j = 0; j < array.counts.y; ++j)
            for (std::uint32_t i = 0; i < array.counts.x; ++i)
                wrong += !isRight({i, j, k}, array.at({i, j, k}) != 0);
    return wrong;
}

std::vector<std::string> boxArguments(const Box3& box, const glm::uvec3& counts) {
    std::vector<std::string> arguments{"--bounds"};
    for (const glm::dvec3& corner : {box.min, box.max})
        for (int axis = 0; axis < 3; ++axis)
            arguments.push_back(nlohmann::json(corner[axis]).dump());
    arguments.push_back("--grid");
    for (int axis = 0; axis < 3; ++axis)
        arguments.push_back(std::to_string(counts[axis]));
    return arguments;
}

// Filled: faces across the axis of projection are set, faces along it are edge-on and set nothing.
TEST(ToolVoxels, CubeHasTheTwoFacesAcrossTheAxis) {
    const TemporaryFolder folder;
    writePly(folder / "cube.ply", reference::makeBox({2, -3, 5}, {3, -2, 6}));
    for (int axis = 0; axis < 3; ++axis) {
        const NpyArray array = voxelsOf(
            {folder / "cube.ply", "-r", "8", "--coverage", "filled", "--axis", kAxisNames[axis]},
            folder / "cube.npy");
        EXPECT_EQ(array.counts, glm::uvec3(8));
        EXPECT_EQ(wrongVoxels(array,
                              [&](const glm::uvec3& voxel, bool isSet) {
                                  return isSet == (voxel[axis] == 0 || voxel[axis] == 7);
                              }),
                  0u)
            << "axis " << kAxisNames[axis];
    }
}

TEST(ToolVoxels, CountsRoundUpFromTheLowCorner) {
    const TemporaryFolder folder;
    writePly(folder / "box.ply", reference::makeBox({1, 1, 1}, {5, 3.2f, 2}));
    const NpyArray array =
        voxelsOf({folder / "box.ply", "--voxel-size", "0.5", "--coverage", "filled", "--axis", "y"},
                 folder / "box.npy");
    EXPECT_EQ(array.counts, glm::uvec3(8, 5, 2));
    EXPECT_EQ(
        wrongVoxels(array, [](const glm::uvec3& voxel,
                              bool isSet) { return isSet == (voxel.y == 0 || voxel.y == 4); }),
        0u);
}

// 0.7f / 7 is a little less than 0.1f: the faces at the high ends must neither be lost nor get a
// layer of voxels of their own.
TEST(ToolVoxels, SidesThatAreMultiplesButForRoundingKeepTheirFaces) {
    const TemporaryFolder folder;
    writePly(folder / "bar.ply", reference::makeBox({0.3f, 0.1f, -0.3f}, {1.0f, 0.3f, -0.1f}));
    for (int axis = 0; axis < 3; ++axis) {
        const NpyArray array = voxelsOf(
            {folder / "bar.ply", "-r", "7", "--coverage", "filled", "--axis", kAxisNames[axis]},
            folder / "bar.npy");
        ASSERT_EQ(array.counts, glm::uvec3(7, 2, 2));
        EXPECT_EQ(wrongVoxels(array,
                              [&](const glm::uvec3& voxel, bool isSet) {
                                  return isSet == (voxel[axis] == 0 ||
                                                   voxel[axis] == array.counts[axis] - 1);
                              }),
                  0u)
            << "axis " << kAxisNames[axis];
    }
}

TEST(ToolVoxels, FlatMeshIsOneVoxelThick) {
    const TemporaryFolder folder;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 normal(0);
        normal[axis] = 1;
        writeObj(folder / "flat.obj", reference::makePlane({1, 2, 3}, normal, 2));
        const NpyArray array = voxelsOf({folder / "flat.obj", "-r", "10"}, folder / "flat.npy");
        glm::uvec3 expected(10);
        expected[axis] = 1;
        EXPECT_EQ(array.counts, expected);
        EXPECT_EQ(array.setCount(), 100u);
    }
}

/// What a coverage must set and what it may set besides.
struct Bounds {
    BitGrid least;
    BitGrid most;
};

Bounds boundsOf(Coverage coverage, const TriangleMesh& mesh, const GridTransform& transform) {
    reference::Options grown;
    grown.grow = 1e-4;
    reference::Options shrunk;
    shrunk.grow = -1e-9;
    switch (coverage) {
    case Coverage::Sampled:
        return {*reference::sampled(mesh, transform), *reference::sampled(mesh, transform)};
    case Coverage::Filled:
        return {*reference::filled(mesh, transform), *reference::filled(mesh, transform, grown)};
    case Coverage::Conservative:
        return {*reference::overlap(mesh, transform, shrunk),
                *reference::overlap(mesh, transform, grown)};
    case Coverage::Separating6:
        return {*reference::separating6(mesh, transform, shrunk),
                *reference::separating6(mesh, transform, grown)};
    case Coverage::Solid:
        break;
    }
    return {*reference::inside(mesh, transform), *reference::inside(mesh, transform)};
}

// Vertices on sixteenths of a voxel: no rounding in the mesh. Sampled and solid must agree
// everywhere; of the others, what a triangle reaches only within 1e-4 of a voxel is left to the
// device's arithmetic.
class ToolReference : public testing::TestWithParam<std::tuple<int, Coverage>> {};

TEST_P(ToolReference, EveryVoxelOfBoundsAndGridAgrees) {
    const auto [axis, coverage] = GetParam();
    const Box3 box{{-3, -2, 0.5}, {3, 2, 2.5}};
    const glm::uvec3 counts(48, 64, 40);
    const GridTransform transform = *GridTransform::box(box, counts, static_cast<Axis>(axis));
    TriangleMesh mesh = reference::makeTorus({0, 0, 1.5f}, 1.6f, 0.7f, 40, 24);
    if (coverage != Coverage::Solid) // which needs a closed mesh
        mesh = reference::merged(
            mesh, reference::makeTriangleSoup({{-2, -1.9, 0.6}, {2, 1.9, 2.4}}, 60, 1.0f, 3));
    mesh = reference::snapped(mesh, transform);
    const TemporaryFolder folder;
    writePly(folder / "mesh.ply", mesh);

    std::vector<std::string> arguments = boxArguments(box, counts);
    arguments.insert(arguments.begin(), folder / "mesh.ply");
    for (const std::string& word : {std::string("--axis"), std::string(kAxisNames[axis]),
                                    std::string("--coverage"), std::string(name(coverage))})
        arguments.emplace_back(word);
    const NpyArray array = voxelsOf(arguments, folder / "mesh.npy");
    ASSERT_EQ(array.counts, counts);

    const Bounds bounds = boundsOf(coverage, mesh, transform);
    EXPECT_GT(bounds.least.count(), 2000u);
    EXPECT_EQ(wrongVoxels(array,
                          [&](const glm::uvec3& voxel, bool isSet) {
                              return isSet ? isSetAt(bounds.most, voxel)
                                           : !isSetAt(bounds.least, voxel);
                          }),
              0u);
}

INSTANTIATE_TEST_SUITE_P(AxesAndCoverages, ToolReference,
                         testing::Combine(testing::Values(0, 1, 2),
                                          testing::Values(Coverage::Sampled, Coverage::Filled,
                                                          Coverage::Conservative,
                                                          Coverage::Separating6, Coverage::Solid)));

TEST(ToolVoxels, SolidTakesTheRuleThatFitsTheMesh) {
    const TemporaryFolder folder;
    const TriangleMesh ball = reference::makeIcosphere({0, 0, 0}, 1.0f, 3);
    TriangleMesh open = ball;
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 40);
    writePly(folder / "ball.ply", ball);
    writePly(folder / "balls.ply",
             reference::merged(ball, reference::makeIcosphere({0.5f, 0, 0}, 1.0f, 3)));
    writePly(folder / "open.ply", open);
    const auto solid = [&](const char* mesh, std::vector<std::string> options) {
        std::vector<std::string> arguments = {folder / mesh, "-r",    "64",
                                              "--coverage",  "solid", "--stats",
                                              "-",           "-o",    folder / "solid.npy"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const ToolResult result = runTool(arguments);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return std::pair(nlohmann::json::parse(result.out)["voxels"], result.err);
    };
    const auto closed = solid("ball.ply", {}).first;
    EXPECT_EQ(closed["solid_rule"], "parity");
    EXPECT_EQ(closed["odd_columns"], 0);

    const auto parity = solid("open.ply", {"--solid-rule", "parity"});
    EXPECT_GT(parity.first["odd_columns"].get<int>(), 0);
    EXPECT_NE(parity.second.find("warning: the mesh is not closed"), std::string::npos);

    const auto voted = solid("open.ply", {});
    EXPECT_EQ(voted.first["solid_rule"], "voted");
    EXPECT_EQ(voted.first["solid_rule_chosen_by"], "mesh");
    EXPECT_GT(voted.first["doubtful"].get<int>(), 0);
    EXPECT_NE(voted.second.find("voxels are doubtful"), std::string::npos) << voted.second;
    // The hole is closed about as the ball was: by a cap a little flatter.
    EXPECT_NEAR(voted.first["set"].get<double>() / closed["set"].get<double>(), 1.0, 0.03);

    const auto flood = solid("open.ply", {"--solid-rule", "flood"});
    EXPECT_EQ(flood.first["enclosed"], 0);
    EXPECT_NE(flood.second.find("encloses nothing"), std::string::npos) << flood.second;

    // A part leaks, another does not.
    writePly(folder / "leak.ply",
             reference::merged(open, reference::makeIcosphere({3, 0, 0}, 0.5f, 3)));
    const auto leak = solid("leak.ply", {"--solid-rule", "flood"});
    EXPECT_GT(leak.first["enclosed"].get<int>(), 0);
    EXPECT_NE(leak.second.find("the mesh is open: " + leak.first["enclosed"].dump() + " of the " +
                               leak.first["set"].dump() + " voxels are enclosed"),
              std::string::npos)
        << leak.second;
    EXPECT_EQ(solid("ball.ply", {"--solid-rule", "flood"}).second.find("warning"),
              std::string::npos);

    // What a slicemap's user is told to use is served.
    const auto slicemap = solid("open.ply", {"--backend", "mrt_slicemap"});
    EXPECT_EQ(slicemap.first["solid_rule"], "parity");
    EXPECT_NE(slicemap.second.find("use --backend auto --solid-rule voted"), std::string::npos)
        << slicemap.second;

    // Overlapping parts: their union.
    const auto balls = solid("balls.ply", {}).first;
    EXPECT_EQ(balls["solid_rule"], "voted");
    EXPECT_EQ(balls["doubtful"], 0);
    EXPECT_GT(balls["set"].get<int>(),
              solid("balls.ply", {"--solid-rule", "parity"}).first["set"].get<int>());

    EXPECT_EQ(
        runTool({folder / "ball.ply", "--solid-rule", "voted", "-o", folder / "a.npy"}).exitCode,
        2);
}

/// Filled by -r: everything that a grid shrunk by 1e-4 of a voxel must have, nothing that one grown
/// by 1e-4 has not. The margin is the rounding of float arithmetic that the coverage allows.
void expectFilledWithin(const TriangleMesh& mesh, const std::string& file, const std::string& stats,
                        const NpyArray& array) {
    const auto json = nlohmann::json::parse(readBytes(stats), nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << stats;
    const auto& grid = json["grid"];
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = grid["bounds"]["min"][axis];
        box.max[axis] = grid["bounds"]["max"][axis];
        ASSERT_EQ(array.counts[axis], grid["size"][axis].get<std::uint32_t>());
    }
    EXPECT_EQ(json["voxels"]["set"].get<std::uint64_t>(), array.setCount());
    const auto axis = static_cast<Axis>(grid["axis"].get<std::string>()[0] - 'x');
    const GridTransform transform = *GridTransform::box(box, array.counts, axis);
    reference::Options grown;
    grown.grow = 1e-4;
    reference::Options shrunk;
    shrunk.grow = -1e-4;
    const BitGrid most = *reference::filled(mesh, transform, grown);
    const BitGrid least = *reference::filled(mesh, transform, shrunk);
    EXPECT_EQ(wrongVoxels(array,
                          [&](const glm::uvec3& voxel, bool isSet) {
                              return isSet ? isSetAt(most, voxel) : !isSetAt(least, voxel);
                          }),
              0u)
        << file;
}

TEST(ToolVoxels, FilledByResolutionStaysWithinTheReferences) {
    const TriangleMesh mesh = reference::makeTorusKnot({0.3f, -1.7f, 12}, 1.3f, 0.4f, 2, 3, 90, 16);
    const TemporaryFolder folder;
    writePly(folder / "knot.ply", mesh);
    for (const char* axis : kAxisNames) {
        const NpyArray array = voxelsOf({folder / "knot.ply", "-r", "70", "--coverage", "filled",
                                         "--axis", axis, "--stats", folder / "knot.json"},
                                        folder / "knot.npy");
        expectFilledWithin(mesh, "torus knot", folder / "knot.json", array);
    }
}

TEST(ToolVoxels, AllMeshFormatsGiveTheSameVoxels) {
    const TriangleMesh mesh = reference::makeIcosphere({0.1f, 0.2f, 0.3f}, 0.77f, 3);
    const TemporaryFolder folder;
    writePly(folder / "mesh.ply", mesh);
    writeObj(folder / "mesh.obj", mesh);
    writeStl(folder / "mesh.stl", mesh);
    writeOff(folder / "mesh.off", mesh);
    (void)voxelsOf({folder / "mesh.ply", "-r", "40"}, folder / "ply.npy");
    const std::string expected = readBytes(folder / "ply.npy");
    for (const std::string format : {"obj", "stl", "off"}) {
        (void)voxelsOf({folder / ("mesh." + format), "-r", "40"}, folder / (format + ".npy"));
        EXPECT_EQ(readBytes(folder / (format + ".npy")), expected) << format;
    }
}

// More than one group of 128 slices, several passes.
TEST(ToolVoxels, BothContextsGiveTheSameBytes) {
    const TemporaryFolder folder;
    writePly(folder / "knot.ply", reference::makeTorusKnot({0, 0, 0}, 1.3f, 0.4f, 2, 3, 200, 32));
    for (const std::string context : {"egl", "osmesa"}) {
        const NpyArray array =
            voxelsOf({folder / "knot.ply", "-r", "300", "--axis", "x", "--context", context},
                     folder / (context + ".npy"));
        EXPECT_EQ(std::max({array.counts.x, array.counts.y, array.counts.z}), 300u);
        EXPECT_GT(array.setCount(), 100000u);
    }
    EXPECT_EQ(readBytes(folder / "egl.npy"), readBytes(folder / "osmesa.npy"));
}

// mrt_slicemap sets the slicemap's voxels; local_slicemap, resampled for files, at least those.
TEST(ToolVoxels, SlicemapBackendsAgree) {
    const TemporaryFolder folder;
    writePly(folder / "knot.ply", reference::makeTorusKnot({0, 0, 0}, 1.3f, 0.4f, 2, 3, 200, 32));
    std::map<std::string, std::uint64_t> counts;
    for (const std::string backend : {"slicemap", "mrt_slicemap", "local_slicemap"})
        counts[backend] = voxelsOf({folder / "knot.ply", "-r", "200", "--coverage", "filled",
                                    "--backend", backend},
                                   folder / (backend + ".npy"))
                              .setCount();
    EXPECT_EQ(readBytes(folder / "slicemap.npy"), readBytes(folder / "mrt_slicemap.npy"));
    EXPECT_GE(counts["local_slicemap"], counts["slicemap"]);
    EXPECT_LT(counts["local_slicemap"], counts["slicemap"] * 2);
}

TEST(ToolVoxels, DefaultsAreResolution256ConservativeAndTheBestAxis) {
    const TemporaryFolder folder;
    writePly(folder / "slab.ply", reference::makeBox({0, 0, 0}, {1, 4, 4}));
    (void)voxelsOf({folder / "slab.ply"}, folder / "default.npy");
    const NpyArray array =
        voxelsOf({folder / "slab.ply", "--resolution", "256", "--coverage", "conservative",
                  "--axis", "x", "--backend", "overlap", "--context", "auto"},
                 folder / "same.npy");
    EXPECT_EQ(array.counts, glm::uvec3(64, 256, 256));
    // The shell of the box.
    EXPECT_EQ(array.setCount(), 64u * 256 * 256 - 62u * 254 * 254);
    EXPECT_EQ(readBytes(folder / "default.npy"), readBytes(folder / "same.npy"));
}

TEST(ToolVoxels, GridMayCutTheMeshOrMissIt) {
    const TemporaryFolder folder;
    writePly(folder / "plane.ply", reference::makePlane({0, 0, 0}, {0, 0, 1}, 8));
    const NpyArray part = voxelsOf({folder / "plane.ply", "--bounds", "-1", "-.5", "-1e0", "1",
                                    "+.5", "1", "--grid", "4", "2", "4", "--coverage", "filled"},
                                   folder / "part.npy");
    EXPECT_EQ(wrongVoxels(part, [](const glm::uvec3& voxel,
                                   bool isSet) { return isSet == (voxel.z == 2); }),
              0u);
    const ToolResult missed = runTool({folder / "plane.ply", "--bounds", "0", "0", "1", "1", "1",
                                       "2", "--grid", "4", "4", "4", "-o", folder / "missed.npy"});
    EXPECT_EQ(missed.exitCode, 0);
    EXPECT_NE(missed.err.find("warning: no voxel is set"), std::string::npos) << missed.err;
    EXPECT_EQ(readNpyArray(folder / "missed.npy").setCount(), 0u);
}

TEST(ToolVoxels, SixteenThousandVoxelsAlongASide) {
    const TemporaryFolder folder;
    TriangleMesh strip = reference::makePlane({0.5f, 0.5f, 0}, {0, 0, 1}, 1);
    for (glm::vec3& position : strip.positions)
        position.y *= 1.0f / 16384.0f;
    writePly(folder / "strip.ply", strip);
    const NpyArray array = voxelsOf({folder / "strip.ply", "-r", "16384"}, folder / "strip.npy");
    EXPECT_EQ(array.counts, glm::uvec3(16384, 1, 1));
    EXPECT_EQ(array.setCount(), 16384u);
}

/// Real meshes of the folder LAMINA_MESH_DIR, where that is set.
TEST(ToolVoxels, RealMeshesStayWithinTheReferences) {
    const char* const directory = std::getenv("LAMINA_MESH_DIR");
    if (directory == nullptr)
        GTEST_SKIP() << "LAMINA_MESH_DIR is not set";
    const TemporaryFolder folder;
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
        if (entry.path().extension() != ".ply" && entry.path().extension() != ".obj")
            continue;
        const NpyArray array = voxelsOf({entry.path().string(), "-r", "100", "--coverage", "filled",
                                         "--stats", folder / "mesh.json"},
                                        folder / "mesh.npy");
        const auto mesh = readMesh(entry.path());
        ASSERT_TRUE(mesh.hasValue()) << entry.path();
        expectFilledWithin(*mesh, entry.path().string(), folder / "mesh.json", array);
    }
}

TEST(ToolVoxels, CompareSetsEveryMethodBesideTheExactVoxels) {
    const TemporaryFolder folder;
    const std::string mesh = folder / "ball.ply";
    writePly(mesh, reference::makeIcosphere({0, 0, 0}, 1, 3));
    const std::string stats = folder / "stats.json";
    const ToolResult run = runTool({mesh, "-r", "48", "--compare", "--stats", stats});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.out.find("missing %"), std::string::npos);

    std::map<std::pair<std::string, std::string>, nlohmann::json> rows;
    const auto record = nlohmann::json::parse(std::ifstream(stats));
    for (const auto& row : record["comparison"])
        if (row.value("solid_rule", "parity") == "parity")
            rows[{row["coverage"], row["backend"]}] = row;
    EXPECT_GE(rows.size(), 5u);
    for (const auto& [method, row] : rows) {
        SCOPED_TRACE(method.first + " by " + method.second);
        EXPECT_GT(row["milliseconds"], 0.0);
        EXPECT_GT(row["passes"], 0);
        // What the tool writes for the same method.
        const std::string voxels = folder / "voxels.npy";
        EXPECT_EQ(row["set"], voxelsOf({mesh, "-r", "48", "--coverage", method.first, "--backend",
                                        method.second},
                                       voxels)
                                  .setCount());
    }
    const auto& exact = rows[{"conservative", "overlap"}];
    EXPECT_EQ(exact["iou"], 1.0);
    EXPECT_EQ(exact["missing"], 0);
    const auto& sampled = rows[{"sampled", "slicemap"}];
    EXPECT_GT(sampled["missing"], 0);
    EXPECT_EQ(sampled["extra"], 0);
    EXPECT_EQ(sampled["set"].get<int>() + sampled["missing"].get<int>(), exact["set"]);
}

TEST(ToolVoxels, CompareSetsEverySolidRuleBesideTheOneThatFitsTheMesh) {
    const TemporaryFolder folder;
    const TriangleMesh ball = reference::makeIcosphere({0, 0, 0}, 1, 3);
    TriangleMesh open = ball;
    open.triangles.resize(open.triangles.size() * 7 / 8);
    for (const bool isClosed : {true, false}) {
        const std::string mesh = folder / (isClosed ? "ball.ply" : "open.ply");
        writePly(mesh, isClosed ? ball : open);
        const ToolResult run = runTool({mesh, "-r", "40", "--compare", "--coverage", "solid",
                                        "--stats", folder / "stats.json"});
        ASSERT_EQ(run.exitCode, 0) << run.err;
        EXPECT_NE(run.out.find("solid voted   overlap"), std::string::npos) << run.out;
        EXPECT_NE(run.out.find(isClosed ? "centre lies inside, by parity" : "by the voted rule"),
                  std::string::npos)
            << run.out;
        std::map<std::string, nlohmann::json> rules;
        const auto record = nlohmann::json::parse(std::ifstream(folder / "stats.json"));
        for (const auto& row : record["comparison"])
            if (row["backend"] == "overlap")
                rules[row["solid_rule"]] = row;
        ASSERT_EQ(rules.size(), 3u);
        for (const auto& [rule, row] : rules) {
            SCOPED_TRACE(rule);
            EXPECT_EQ(row["exact"], isClosed ? "solid parity" : "solid voted");
            EXPECT_EQ(row["set"], voxelsOf({mesh, "-r", "40", "--coverage", "solid", "--backend",
                                            "overlap", "--solid-rule", rule},
                                           folder / "voxels.npy")
                                      .setCount());
        }
        EXPECT_EQ(rules["voted"]["iou"], 1.0);
        EXPECT_EQ(rules["parity"]["iou"] == 1.0, isClosed);
        EXPECT_EQ(rules["flood"]["missing"].get<int>() > 0, !isClosed);
        EXPECT_GT(rules["flood"]["extra"], 0);
    }
}

TEST(ToolVoxels, CompareKeepsToTheCoverageAskedFor) {
    const TemporaryFolder folder;
    const std::string mesh = folder / "ball.ply";
    writePly(mesh, reference::makeIcosphere({0, 0, 0}, 1, 2));
    const ToolResult run =
        runTool({mesh, "-r", "16", "--compare", "--coverage", "solid", "--stats", "-"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto rows = nlohmann::json::parse(run.out)["comparison"];
    ASSERT_FALSE(rows.empty());
    for (const auto& row : rows)
        EXPECT_EQ(row["coverage"], "solid");
    EXPECT_EQ(runTool({mesh, "--compare", "--solid-rule", "voted"}).exitCode, 2);
    EXPECT_EQ(runTool({mesh, "--compare", "-o", folder / "a.npy"}).exitCode, 2);
}

} // namespace
} // namespace lamina::test
