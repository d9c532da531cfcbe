#define GLAD_GL_IMPLEMENTATION
#include "gl/glad.hpp"
