#include "uploaded_mesh.hpp"

namespace lamina::bench {

Result<UploadedMesh> upload(const Device& device, NamedMesh& named) {
    auto mesh = named.get();
    if (!mesh)
        return mesh.error();
    auto buffers = MeshBuffers::upload(device, **mesh);
    if (!buffers)
        return buffers.error();
    const MeshView view = buffers->view();
    return UploadedMesh{*mesh, std::move(*buffers), view};
}

Result<UploadedCase> upload(const Device& device, const Case& what) {
    auto uploaded = upload(device, *what.mesh);
    if (!uploaded)
        return uploaded.error();
    auto transform = benchGrid(*uploaded->mesh, what.resolution);
    if (!transform)
        return transform.error();
    return UploadedCase{std::move(*uploaded), *transform};
}

} // namespace lamina::bench
