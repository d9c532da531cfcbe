// What a source's vertex stage gives to every raster backend.
// A DrawSource supplies `LaminaVertex laminaVertex()`, with whatever inputs, uniforms and buffers it
// needs; Lamina supplies main().
struct LaminaVertex {
    vec3 position; // World space (local space of the model matrix for a MeshView).
    vec3 normal;   // World space; need not have unit length; zero if unknown.
    uint material; // Index into the material table.
};

// RGBA in [0,1]; laminaVertex() may assign it. Backends that record colours multiply it by the
// material's.
vec4 laminaVertexColor = vec4(1.0);
