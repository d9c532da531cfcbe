#pragma once

#include <cstdint>

namespace lamina::detail {

/// Transposes a 32 x 32 bit matrix: bit c of words[r] becomes bit r of words[c].
inline void transpose32(std::uint32_t words[32]) {
    // Swaps the off-diagonal quarters of ever smaller squares.
    std::uint32_t mask = 0x0000ffffu;
    for (std::uint32_t half = 16; half != 0; half >>= 1, mask ^= mask << half)
        for (std::uint32_t row = 0; row < 32; row = ((row | half) + 1) & ~half) {
            const std::uint32_t swapped = ((words[row] >> half) ^ words[row | half]) & mask;
            words[row] ^= swapped << half;
            words[row | half] ^= swapped;
        }
}

} // namespace lamina::detail
