// The contract of lamina/transmittance.glsl and lamina::transmittance.
#include "gl/support/transmittance_probe.hpp"
