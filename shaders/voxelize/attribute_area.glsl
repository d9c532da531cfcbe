// Area and centroid of the part of a convex polygon in a plane, given by the lines that bound it.
//
// Each line is clipped by all others; what is left of it is an edge of the polygon. With c the distance
// of a line from the origin (positive on the inside), L the length of its edge and m the edge's middle,
// the divergence theorem gives
//
//     area = 1/2 sum of c L,    area * centroid = 1/3 sum of c L m.
//
// No list of vertices, so nothing is indexed by a variable, and no loops.

// Inside: dot(normal, p) + offset >= 0; normal has unit length.
struct LaminaLine {
    vec2 normal;
    float offset;
};

// Lines closer to parallel than this are compared by their offsets: of a box and a triangle, which may
// run together, and of two edges of a triangle, whose angle may be small.
const float kParallel = 1.0e-4;
const float kParallelEdges = 1.0e-6;
// Of two lines that run together, within this, the first one counts.
const float kTie = 1.0e-5;

// What is left of points [t.x, t.y] of a line on the inside of another. isFirst: of the two.
void laminaClip(LaminaLine line, LaminaLine other, bool isFirst, float parallel, inout vec2 t) {
    float along = other.normal.y * line.normal.x - other.normal.x * line.normal.y;
    float turn = dot(line.normal, other.normal);
    float inside = other.offset - line.offset * turn;
    if (abs(along) < parallel)
        t = inside < (isFirst || turn < 0.0 ? -kTie : kTie) ? vec2(1.0, -1.0) : t;
    else if (along > 0.0)
        t.x = max(t.x, -inside / along);
    else
        t.y = min(t.y, -inside / along);
}

// Adds an edge to (area * centroid * 3, area * 2).
void laminaAddEdge(LaminaLine line, vec2 t, inout vec3 sums) {
    float part = line.offset * max(t.y - t.x, 0.0);
    vec2 middle = vec2(-line.normal.y, line.normal.x) * (0.5 * (t.x + t.y)) - line.normal * line.offset;
    sums += part * vec3(middle, 1.0);
}

#define LAMINA_CLIP(i, j) \
    if (i != j) laminaClip(lines[i], lines[j], i < j, i < 3 && j < 3 ? kParallelEdges : kParallel, t)
#define LAMINA_EDGE(i)                                                                                 \
    {                                                                                                  \
        vec2 t = vec2(-8.0, 8.0);                                                                      \
        LAMINA_CLIP(i, 0); LAMINA_CLIP(i, 1); LAMINA_CLIP(i, 2); LAMINA_CLIP(i, 3); LAMINA_CLIP(i, 4); \
        LAMINA_CLIP(i, 5); LAMINA_CLIP(i, 6); LAMINA_CLIP(i, 7); LAMINA_CLIP(i, 8);                    \
        laminaAddEdge(lines[i], t, sums);                                                              \
    }

// Area of the polygon that nine lines bound, the first three of them a triangle's edges; xy: its
// centroid, if the area is above 0. The origin lies near the polygon: what a line's ends miss by
// rounding counts times the line's distance from it, which for the edges of a needle is small then.
vec3 laminaPolygon(LaminaLine lines[9]) {
    vec3 sums = vec3(0.0);
    LAMINA_EDGE(0) LAMINA_EDGE(1) LAMINA_EDGE(2) LAMINA_EDGE(3) LAMINA_EDGE(4)
    LAMINA_EDGE(5) LAMINA_EDGE(6) LAMINA_EDGE(7) LAMINA_EDGE(8)
    float area = 0.5 * max(sums.z, 0.0);
    return vec3(area > 0.0 ? sums.xy / (3.0 * area) : vec2(0.0), area);
}
