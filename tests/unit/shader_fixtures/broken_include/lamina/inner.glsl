float scaled(float x) {
    return 0.5 * x;
}

float broken(float x) {
    return scaled(x) + missing;
}
