#include <reference/fog_errors.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

namespace lamina::reference {

double relativeRmse(std::span<const double> found, std::span<const double> expected) {
    double differences = 0.0;
    double values = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        differences += (found[i] - expected[i]) * (found[i] - expected[i]);
        values += expected[i] * expected[i];
    }
    return std::sqrt(differences / values);
}

FogErrors fogErrors(std::span<const double> found, std::span<const double> expected,
                    std::span<const double> unshadowed) {
    FogErrors errors;
    errors.airlight = relativeRmse(found, expected);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double shadow = unshadowed[i] - expected[i];
        if (shadow <= 0.02 * unshadowed[i])
            continue;
        const double error = (unshadowed[i] - found[i]) / shadow - 1.0;
        errors.strength += std::abs(error);
        errors.bias += error;
        ++errors.shadows;
    }
    const auto count = static_cast<double>(std::max<std::size_t>(errors.shadows, 1));
    errors.strength /= count;
    errors.bias /= count;
    return errors;
}

bool passesLight(const glm::dvec3& eye, const glm::dvec3& point,
                 std::span<const VirtualLight> lights) {
    const double length = glm::distance(point, eye);
    const glm::dvec3 along = (point - eye) / length;
    for (const VirtualLight& light : lights) {
        const glm::dvec3 offset = light.light.position - eye;
        const double reached = glm::dot(offset, along);
        if (light.radius > 0.0 && reached < length + light.radius &&
            glm::length(offset - reached * along) < 1.5 * light.radius)
            return true;
    }
    return false;
}

std::vector<double> forEach(std::size_t count, const std::function<double(std::size_t)>& value) {
    std::vector<double> values(count);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < count; i = next++)
            values[i] = value(i);
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i)
        threads.emplace_back(work);
    work();
    for (std::thread& thread : threads)
        thread.join();
    return values;
}

} // namespace lamina::reference
