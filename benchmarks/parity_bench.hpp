#pragma once

#include <lamina/core/result.hpp>
#include <lamina/core/triangle_mesh.hpp>
#include <lamina/gl/device.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lamina::bench {

template<class T>
T need(Result<T> result) {
    if (result)
        return std::move(*result);
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
    std::exit(1);
}

inline void need(Result<void> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().text.c_str());
        std::exit(1);
    }
}

/// Median milliseconds of a call: wall, and of all threads.
struct Time {
    double wall = 0.0;
    double processor = 0.0;
};

inline double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// Runs the calls in turn, so that what else the machine does hits all of them alike.
template<std::size_t count>
std::array<Time, count> measure(const std::array<std::function<void()>, count>& calls, int rounds) {
    std::array<std::vector<double>, count> walls;
    std::array<std::vector<double>, count> processors;
    for (int round = -1; round < rounds; ++round)
        for (std::size_t i = 0; i < count; ++i) {
            const auto start = std::chrono::steady_clock::now();
            const std::clock_t clock = std::clock();
            calls[i]();
            if (round < 0)
                continue; // compiles programs
            const std::chrono::duration<double, std::milli> wall =
                std::chrono::steady_clock::now() - start;
            walls[i].push_back(wall.count());
            processors[i].push_back(1e3 * static_cast<double>(std::clock() - clock) /
                                    CLOCKS_PER_SEC);
        }
    std::array<Time, count> times;
    for (std::size_t i = 0; i < count; ++i)
        times[i] = {median(walls[i]), median(processors[i])};
    return times;
}

struct Shape {
    std::string name;
    TriangleMesh mesh;
};

/// Each prints a table, measured in one run.
void printBuilding(const Device& device, std::span<const Shape> meshes, int rounds);
void printAccuracy(const Device& device, std::span<const Shape> meshes, std::size_t count);
void printVariants(const Device& device, std::span<const Shape> meshes, std::size_t count,
                   int rounds);
void printClipping(const Device& device, const Shape& shape, int rounds);

} // namespace lamina::bench
