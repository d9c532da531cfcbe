#pragma once

// glad's two loader functions get names of ours, so that a host which links its own glad statically
// beside ours meets no duplicate symbols. Everything else in the header is data or types.
#define gladLoadGLContextUserPtr laminaGladLoadContextUserPtr
#define gladLoadGLContext laminaGladLoadContext

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <glad/gl.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
