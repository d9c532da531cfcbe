// Random numbers by hashing (PCG): the same on every device.

uint laminaHash(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In [0,1).
float laminaRandom(uint seed) {
    return float(laminaHash(seed) >> 8u) / 16777216.0;
}
