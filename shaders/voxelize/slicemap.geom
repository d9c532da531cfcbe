// Triangle set-up of the slicemap backends.
//
// One invocation owns one triangle:
//   1. drop it if it is not finite or lies outside the depths of this pass;
//   2. project it to columns and work out its exact edges and depth plane (LaminaColumnTriangle);
//   3. emit a polygon that covers it after dilation by `dilation.x` pixels, so that the rasterizer's
//      sub-pixel snapping loses no column; the fragment stage decides coverage exactly.
// Degenerate projections (edge-on triangles) cover no column centre and are dropped.
#include <voxelize/draw_block.glsl>
#include <voxelize/column_triangle.glsl>

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

in LaminaVertexStage {
    dvec3 column;
} laminaIn[];

layout(location = 0) flat out dvec4 laminaEdge0;
layout(location = 2) flat out dvec4 laminaEdge1;
layout(location = 4) flat out dvec4 laminaEdge2;
layout(location = 6) flat out dvec3 laminaDepthPlane;
layout(location = 8) flat out dvec2 laminaDepthRange;

// Mesa warns of variables that it cannot see set before the functions below read them.
LaminaColumnTriangle triangle = LaminaColumnTriangle(dvec4[3](dvec4(0.0lf), dvec4(0.0lf), dvec4(0.0lf)), dvec3(0.0lf), dvec2(0.0lf));

void emit(dvec2 column) {
    laminaEdge0 = triangle.edges[0];
    laminaEdge1 = triangle.edges[1];
    laminaEdge2 = triangle.edges[2];
    laminaDepthPlane = triangle.depthPlane;
    laminaDepthRange = triangle.depthRange;
    gl_Position = vec4(vec2(column * (2.0lf / dvec2(laminaDraw.size.xy)) - 1.0lf), 0.0, 1.0);
    EmitVertex();
}

void emitRectangle(dvec2 low, dvec2 high) {
    emit(low);
    emit(dvec2(high.x, low.y));
    emit(dvec2(low.x, high.y));
    emit(high);
    EndPrimitive();
}

vec2 unitNormal(dvec4 edge) {
    vec2 direction = vec2(edge.zw);
    return vec2(direction.y, -direction.x) / length(direction);
}

// A triangle in front of the eye: its three edges moved outwards, or, where that would make a spike,
// the rectangle around its longest edge.
void emitDilated(dvec2 p[3]) {
    // Corners far outside the grid lose more to the rounding of normalized device coordinates.
    dvec2 farthest = max(abs(p[0]), max(abs(p[1]), abs(p[2])));
    float radius = laminaDraw.dilation.x + float(max(farthest.x, farthest.y)) * 4.8e-7;
    vec2 normals[3] = vec2[](unitNormal(triangle.edges[0]), unitNormal(triangle.edges[1]), unitNormal(triangle.edges[2]));
    vec3 miter = 1.0 + vec3(dot(normals[2], normals[0]), dot(normals[0], normals[1]), dot(normals[1], normals[2]));
    if (min(miter.x, min(miter.y, miter.z)) > 1.0e-4) {
        emit(p[0] + dvec2((normals[2] + normals[0]) * (radius / miter.x)));
        emit(p[1] + dvec2((normals[0] + normals[1]) * (radius / miter.y)));
        emit(p[2] + dvec2((normals[1] + normals[2]) * (radius / miter.z)));
        EndPrimitive();
        return;
    }
    vec3 squaredLengths = vec3(dot(p[1] - p[0], p[1] - p[0]), dot(p[2] - p[1], p[2] - p[1]), dot(p[0] - p[2], p[0] - p[2]));
    int first = squaredLengths.x >= max(squaredLengths.y, squaredLengths.z) ? 0 : (squaredLengths.y >= squaredLengths.z ? 1 : 2);
    dvec2 a = p[first];
    dvec2 b = p[(first + 1) % 3];
    dvec2 c = p[(first + 2) % 3];
    vec2 along = normalize(vec2(b - a));
    vec2 across = vec2(-along.y, along.x);
    float height = dot(vec2(c - a), across);
    dvec2 low = dvec2(across * (min(height, 0.0) - 2.0 * radius));
    dvec2 high = dvec2(across * (max(height, 0.0) + 2.0 * radius));
    dvec2 extension = dvec2(along * (2.0 * radius));
    emit(a - extension + low);
    emit(b + extension + low);
    emit(a - extension + high);
    emit(b + extension + high);
    EndPrimitive();
}

// A perspective triangle that reaches behind the eye cut: the rectangle around its visible part.
// h: (column x * depth, column y * depth, depth) of the vertices.
void emitCut(dvec3 h[3], double cutDepth) {
    double orientation = dot(h[0], cross(h[1], h[2]));
    if (orientation == 0.0lf)
        return;
    dvec2 size = dvec2(laminaDraw.size.xy);
    dvec2 low = size;
    dvec2 high = dvec2(0.0lf);
    double anchorDepth = 0.0lf;
    for (int i = 0; i < 3; ++i) {
        dvec3 a = h[i];
        dvec3 b = h[(i + 1) % 3];
        if (a.z < cutDepth && b.z < cutDepth) {
            triangle.edges[i] = dvec4(0.0lf);
            continue;
        }
        // From the end in front to the end behind, for both triangles of the edge.
        if (a.z < cutDepth) {
            double t = (cutDepth - b.z) / (a.z - b.z);
            a = dvec3(b.xy + (a.xy - b.xy) * t, cutDepth);
        } else if (b.z < cutDepth) {
            double t = (cutDepth - a.z) / (b.z - a.z);
            b = dvec3(a.xy + (b.xy - a.xy) * t, cutDepth);
        }
        dvec2 pa = a.xy / a.z;
        dvec2 pb = b.xy / b.z;
        triangle.edges[i] = laminaOrientedEdge(pa, pb, orientation);
        low = min(low, min(pa, pb));
        high = max(high, max(pa, pb));
    }
    // 1/depth = dot(normal, (column x, column y, 1)).
    dvec3 normal = (cross(h[0], h[1]) + cross(h[1], h[2]) + cross(h[2], h[0])) / orientation;
    triangle.depthPlane = dvec3(normal.xy, dot(normal, dvec3(triangle.edges[0].xy, 1.0lf)));
    double margin = double(laminaDraw.dilation.x);
    low = clamp(low - margin, dvec2(0.0lf), size);
    high = clamp(high + margin, dvec2(0.0lf), size);
    if (low.x < high.x && low.y < high.y)
        emitRectangle(low, high);
}

void main() {
    dvec3 h[3] = dvec3[](laminaIn[0].column, laminaIn[1].column, laminaIn[2].column);
    for (int i = 0; i < 3; ++i)
        if (any(isnan(h[i])) || any(isinf(h[i])))
            return;
    triangle.depthRange = dvec2(min(h[0].z, min(h[1].z, h[2].z)), max(h[0].z, max(h[1].z, h[2].z)));
    if (triangle.depthRange.x > laminaDraw.passDepths.y || triangle.depthRange.y < laminaDraw.passDepths.x)
        return;

    bool isPerspective = (laminaDraw.size.w & LAMINA_GRID_PERSPECTIVE) != 0u;
    double cutDepth = laminaDraw.depthRange.z;
    if (isPerspective && triangle.depthRange.x < cutDepth) {
        emitCut(h, cutDepth);
        return;
    }

    dvec2 p[3];
    dvec3 values;
    for (int i = 0; i < 3; ++i) {
        double w = isPerspective ? h[i].z : 1.0lf;
        p[i] = h[i].xy / w;
        values[i] = isPerspective ? 1.0lf / h[i].z : h[i].z;
    }
    dvec2 low = min(p[0], min(p[1], p[2]));
    dvec2 high = max(p[0], max(p[1], p[2]));
    if (any(greaterThan(low, dvec2(laminaDraw.size.xy))) || any(lessThan(high, dvec2(0.0lf))))
        return;
    if (!laminaSetUpTriangle(p, values, triangle))
        return;
    emitDilated(p);
}
