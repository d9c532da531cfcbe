#include "grid_plan.hpp"

#include "failure.hpp"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <unistd.h>

namespace lamina::tool {
namespace {

/// Far above what any device takes, far below overflow of voxel indices.
constexpr double kMaxCount = 1u << 24;
/// Most of a voxel that the rounding of coordinates may excuse.
constexpr double kMaxSlack = 1e-3;

/// A step of float numbers at the ends of a side: how far it may be from what was meant.
double coordinateRounding(const Box3& box, int axis) {
    return std::ldexp(std::max(std::abs(box.min[axis]), std::abs(box.max[axis])), -23);
}

int longestAxis(const glm::dvec3& size) {
    const int first = size.y > size.x ? 1 : 0;
    return size.z > size[first] ? 2 : first;
}

/// Cubes of about `edge` around the mesh's box. `edgeRounding`: relative uncertainty of `edge`.
void placeCubes(const Box3& mesh, double edge, double edgeRounding, GridPlan& plan) {
    const glm::dvec3 size = mesh.size();
    double grown = edge;
    for (int axis = 0; axis < 3; ++axis) {
        const double voxels = size[axis] / edge;
        const double slack = std::min(kMaxSlack, 1e-9 + coordinateRounding(mesh, axis) / edge +
                                                     voxels * edgeRounding);
        const double count = std::max(1.0, std::ceil(voxels - slack));
        if (!(count <= kMaxCount))
            throw Failure(
                ExitCode::Unsupported,
                fmt::format("plan grid: {:.4g} voxels of {:.6g} along {}, expected at most "
                            "{:.0f}; use a larger voxel size",
                            count, edge, "xyz"[axis], kMaxCount));
        plan.counts[axis] = static_cast<std::uint32_t>(count);
        grown = std::max(grown, size[axis] / count);
    }
    plan.voxelSize = glm::dvec3(grown);
    plan.bounds.min = mesh.min;
    for (int axis = 0; axis < 3; ++axis)
        plan.bounds.max[axis] =
            std::max(mesh.max[axis], mesh.min[axis] + grown * plan.counts[axis]);
}

void placeAround(const GridRequest& request, const Box3& mesh, GridPlan& plan) {
    const glm::dvec3 size = mesh.size();
    const int longest = longestAxis(size);
    if (!(size[longest] > 0.0))
        throw Failure(
            ExitCode::BadMesh,
            fmt::format("plan grid: expected a mesh with some extent, found all its "
                        "triangles in the point ({:g}, {:g}, {:g}); give --bounds and --grid",
                        mesh.min.x, mesh.min.y, mesh.min.z));
    if (request.resolution)
        placeCubes(mesh, size[longest] / *request.resolution,
                   coordinateRounding(mesh, longest) / size[longest], plan);
    else
        placeCubes(mesh, *request.voxelSize, 0.0, plan);
}

glm::dvec3 coveredColumns(const TriangleMesh& mesh, const glm::dvec3& voxelSize) {
    glm::dvec3 sum(0.0);
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[triangle.x]);
        const glm::dvec3 b(mesh.positions[triangle.y]);
        const glm::dvec3 c(mesh.positions[triangle.z]);
        sum += glm::abs(glm::cross((b - a) / voxelSize, (c - a) / voxelSize));
    }
    return 0.5 * sum;
}

/// z wins ties, then y: a column of bits along z is what most formats expect.
Axis bestAxis(const glm::dvec3& columns) {
    const double tie = 1.0 + 1e-6;
    int best = 2;
    for (const int axis : {1, 0})
        best = columns[axis] > columns[best] * tie ? axis : best;
    return static_cast<Axis>(best);
}

/// Of a closed mesh; of others what its triangles and the low corner of its box span.
double enclosedVolume(const TriangleMesh& mesh) {
    const glm::dvec3 origin = mesh.bounds().min;
    double sum = 0.0;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a = glm::dvec3(mesh.positions[triangle.x]) - origin;
        const glm::dvec3 b = glm::dvec3(mesh.positions[triangle.y]) - origin;
        const glm::dvec3 c = glm::dvec3(mesh.positions[triangle.z]) - origin;
        sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return std::abs(sum);
}

} // namespace

bool isCubic(const glm::dvec3& voxelSize) {
    const auto [shortest, longest] = std::minmax({voxelSize.x, voxelSize.y, voxelSize.z});
    return longest - shortest <= 1e-6 * longest;
}

double GridPlan::bytes() const {
    const glm::uvec3 axes = boxGridAxes(axis);
    return std::ceil(counts[axes.z] / 128.0) * 16.0 * counts[axes.x] * counts[axes.y];
}

GridPlan planGrid(const GridRequest& request, const TriangleMesh& mesh) {
    GridPlan plan;
    if (request.bounds) {
        plan.bounds = *request.bounds;
        plan.counts = *request.counts;
        plan.voxelSize = plan.bounds.size() / glm::dvec3(plan.counts);
    } else {
        placeAround(request, mesh.bounds(), plan);
    }
    plan.coveredColumns = coveredColumns(mesh, plan.voxelSize);
    plan.isAxisChosen = !request.axis;
    plan.axis = request.axis ? *request.axis : bestAxis(plan.coveredColumns);
    return plan;
}

double expectedVoxels(const GridPlan& plan, const TriangleMesh& mesh, Coverage coverage) {
    const double all = static_cast<double>(plan.counts.x) * plan.counts.y * plan.counts.z;
    double voxels = plan.coveredColumns.x + plan.coveredColumns.y + plan.coveredColumns.z;
    if (coverage == Coverage::Solid)
        voxels += enclosedVolume(mesh) / (plan.voxelSize.x * plan.voxelSize.y * plan.voxelSize.z);
    return std::min(voxels, all);
}

double attributeBytes(const GridPlan& plan, double voxels) {
    constexpr double kRecord = 16.0; // On the device.
    constexpr double kSums = 64.0;   // Beside it, for a batch of voxels at a time.
    constexpr double kBatchVoxels = 1u << 23u;
    constexpr double kHost = 22.0;         // AttributeGrid.
    constexpr double kRanks = 12.0 / 16.0; // On device and host, for each byte of the grid.
    if (voxels <= 0.0)
        return 0.0;
    return (kRecord + kHost) * voxels + kSums * std::min(voxels, kBatchVoxels) +
           kRanks * plan.bytes();
}

void checkMemory(const GridPlan& plan, double attributeVoxels, double limitBytes) {
    const double attributes = attributeBytes(plan, attributeVoxels);
    const double needed = 2.0 * plan.bytes() + attributes;
    if (needed <= limitBytes)
        return;
    const auto mebibytes = [](double bytes) { return std::ceil(bytes / 1048576.0); };
    std::string text =
        fmt::format("plan grid: {} x {} x {} voxels take {:.0f} MiB on device and host together",
                    plan.counts.x, plan.counts.y, plan.counts.z, mebibytes(needed));
    if (attributes > 0.0)
        text += fmt::format(", {:.0f} MiB of them for the attributes of about {:.0f} set voxels",
                            mebibytes(attributes), attributeVoxels);
    throw Failure(ExitCode::Unsupported,
                  fmt::format("{}, expected at most {:.0f} MiB; use larger voxels{} or "
                              "--memory-limit",
                              text, std::floor(limitBytes / 1048576.0),
                              attributes > 0.0 ? ", --attributes none" : ""));
}

double physicalMemory() {
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<double>(sysconf(_SC_PAGESIZE));
}

} // namespace lamina::tool
