// Uses something of every installed component, so that a static one must bring all it links.
#include <lamina/core/version.hpp>
#include <lamina/gl/device.hpp>
#include <lamina/grid/bit_grid.hpp>
#include <lamina/headless/context.hpp>
#ifdef HAS_MESH_IO
#include <lamina/mesh_io/mesh_file.hpp>
#endif
#ifdef HAS_GRID_IO
#include <lamina/grid_io/grid_file.hpp>
#endif
#ifdef HAS_TRANSMITTANCE
#include <lamina/transmittance/transmittance.hpp>
#endif
#ifdef HAS_AREA_LIGHT
#include <lamina/area_light/area_light.hpp>
#endif
#ifdef HAS_PARITY
#include <lamina/parity/sprite_set.hpp>
#include <lamina/parity/sprite_transform.hpp>
#endif
#ifdef HAS_REFRACTION
#include <lamina/refraction/refraction.hpp>
#endif
#ifdef HAS_SHADOW_VOLUMES
#include <lamina/shadow_volumes/shadow_volumes.hpp>
#endif

#include <cstdio>

namespace {

bool expect(bool condition, const char* what) {
    if (!condition)
        std::printf("expected: %s\n", what);
    return condition;
}

bool contextIsMade() {
    const auto context = lamina::headless::Context::create();
    return expect(context.hasValue(), "a headless context");
}

bool meshIsRead() {
#ifdef HAS_MESH_IO
    const auto mesh = lamina::readMesh("no_such_file.obj");
    return expect(!mesh && mesh.error().code == lamina::ErrorCode::NotFound,
                  "NotFound for a missing mesh");
#else
    return true;
#endif
}

bool gridIsWritten() {
#ifdef HAS_GRID_IO
    const auto transform =
        lamina::GridTransform::box({glm::dvec3(0.0), glm::dvec3(4.0)}, glm::uvec3(4));
    if (!expect(transform.hasValue(), "a box grid"))
        return false;
    auto grid = lamina::BitGrid::create(*transform);
    if (!expect(grid.hasValue(), "a host grid"))
        return false;
    grid->set({1, 2, 3});
    for (const char* file : {"component_program.npy", "component_program.vdb"}) {
        const bool possible = lamina::canWrite(*lamina::gridFormat(file));
        if (!expect(lamina::writeGrid(file, *grid).hasValue() == possible, file))
            return false;
    }
#endif
    return true;
}

bool transmittanceIsMade() {
#ifdef HAS_TRANSMITTANCE
    const auto context = lamina::headless::Context::create();
    if (!expect(context.hasValue(), "a headless context"))
        return false;
    const auto device = lamina::Device::fromCurrentContext(
        [&](const char* name) { return context->getProcAddress(name); });
    return expect(device && lamina::Transmittance::create(*device), "transmittance shadows");
#else
    return true;
#endif
}

bool thicknessIsRefused() {
#ifdef HAS_REFRACTION
    const auto context = lamina::headless::Context::create();
    if (!expect(context.hasValue(), "a headless context"))
        return false;
    const auto device = lamina::Device::fromCurrentContext(
        [&](const char* name) { return context->getProcAddress(name); });
    auto refraction = lamina::Refraction::create(*device);
    return expect(refraction && !refraction->thicknessMap()->downloadReport(),
                  "a thickness map that asks for prepare()");
#else
    return true;
#endif
}

bool spriteIsRefused() {
#ifdef HAS_PARITY
    const auto context = lamina::headless::Context::create();
    const auto device = lamina::Device::fromCurrentContext(
        [&](const char* name) { return context->getProcAddress(name); });
    auto set = lamina::SpriteSet::create(*device);
    if (!expect(set.hasValue(), "a sprite set"))
        return false;
    const lamina::SpriteInstance none[1] = {};
    return expect(!set->update(none), "a sprite that was not built to be refused") &&
           expect(lamina::fitSprite({glm::dvec3(0.0), glm::dvec3(1.0)}, {1, 2, 3}, 64).hasValue(),
                  "the place of a sprite");
#else
    return true;
#endif
}

bool shadowsAreMade() {
#ifdef HAS_SHADOW_VOLUMES
    auto context = lamina::headless::Context::create();
    if (!expect(context.hasValue(), "a headless context"))
        return false;
    auto device = lamina::Device::fromCurrentContext(
        [&](const char* name) { return context->getProcAddress(name); });
    if (!expect(device.hasValue(), "a device"))
        return false;
    auto volumes = lamina::ShadowVolumes::create(*device);
    return expect(volumes && volumes->apply().error().code == lamina::ErrorCode::InvalidArgument,
                  "shadow volumes that ask for prepare()");
#else
    return true;
#endif
}

bool lightIsSampled() {
#ifdef HAS_AREA_LIGHT
    const auto lights = lamina::sampleVirtualLights(lamina::RectangleLight{}, 64);
    return expect(lights && lights->size() == 64, "virtual lights");
#else
    return true;
#endif
}

} // namespace

int main() {
    static_assert(LAMINA_VERSION_MAJOR >= 0);
    return contextIsMade() && meshIsRead() && gridIsWritten() && transmittanceIsMade() &&
                   spriteIsRefused() && shadowsAreMade() && thicknessIsRefused() && lightIsSampled()
               ? 0
               : 1;
}
