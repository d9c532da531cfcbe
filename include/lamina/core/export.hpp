#pragma once

/// Marks what leaves a shared library; everything else is hidden.
#if defined(LAMINA_STATIC)
#define LAMINA_API
#else
#define LAMINA_API __attribute__((visibility("default")))
#endif
