// Half the directions as a square: an octahedron's upper half, turned by 45 degrees. All its texels span solid
// angles within a factor of 2.6 of each other.

// direction: z > 0, any length. Result: in [-1,1]^2.
vec2 laminaHemisphereToSquare(vec3 direction) {
    vec2 place = direction.xy / (abs(direction.x) + abs(direction.y) + direction.z);
    return vec2(place.x + place.y, place.x - place.y);
}

// The inverse; a unit vector.
vec3 laminaSquareToHemisphere(vec2 square) {
    vec2 place = 0.5 * vec2(square.x + square.y, square.x - square.y);
    return normalize(vec3(place, 1.0 - abs(place.x) - abs(place.y)));
}
