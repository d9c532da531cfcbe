#include <lamina/core/triangle_mesh.hpp>

int main() {
    const lamina::TriangleMesh mesh;
#ifdef MISUSE
    lamina::validate(mesh);
#else
    if (!lamina::validate(mesh))
        return 1;
#endif
}
