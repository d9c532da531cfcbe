#include <lamina/inner.glsl>

float outer(float x) {
    return broken(x);
}
