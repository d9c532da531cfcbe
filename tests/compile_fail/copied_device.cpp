#include <lamina/gl/device.hpp>

#include <utility>

lamina::Device handedOver(lamina::Device& device) {
#ifdef MISUSE
    return device;
#else
    return std::move(device);
#endif
}
