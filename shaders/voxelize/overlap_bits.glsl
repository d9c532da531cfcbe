// The voxels that triangles meet, as bits of the grid's words.

void laminaBeginTriangle(uint triangle, dvec3 corners[3]) {}

// Sets slices [first, last] of a column. One atomic a word: other triangles set bits of it too.
void laminaVisitSlices(int x, int y, int first, int last) {
    for (int word = first >> 5; word <= last >> 5; ++word) {
        int low = max(first - word * 32, 0);
        int high = min(last - word * 32, 31);
        atomicOr(laminaWords[laminaWordIndex(x, y, word)], (0xffffffffu >> uint(31 - high)) & (0xffffffffu << uint(low)));
    }
}
