#include "voxelize/automatic_voxelizer.hpp"

#include "gl/device_state.hpp"
#include "voxelize/overlap_grid.hpp"
#include "voxelize/overlap_voxelizer.hpp"
#include "voxelize/slicemap_voxelizer.hpp"

namespace lamina {
namespace {

class AutomaticVoxelizer final : public Voxelizer {
public:
    AutomaticVoxelizer(std::shared_ptr<gl::DeviceState> device, Coverage coverage,
                       std::unique_ptr<Voxelizer> overlap, std::unique_ptr<Voxelizer> slicemap)
        : mDevice(std::move(device))
        , mCoverage(coverage)
        , mOverlap(std::move(overlap))
        , mSlicemap(std::move(slicemap)) {
        use(*mOverlap);
    }

    [[nodiscard]] Backend backend() const override { return mUsed->backend(); }
    [[nodiscard]] VoxelizerCapabilities capabilities() const override {
        VoxelizerCapabilities capabilities = mUsed->capabilities();
        capabilities.splits = mSlicemap->capabilities().splits;
        capabilities.perspective = true;
        capabilities.anyDistribution = true;
        return capabilities;
    }
    [[nodiscard]] Result<VoxelizeStats> voxelize(std::span<const GeometrySource> sources,
                                                 const GridTransform& transform,
                                                 VoxelGrid& out) override {
        Voxelizer& chosen = isOverlapGrid(transform) ? *mOverlap : *mSlicemap;
        auto stats = chosen.voxelize(sources, transform, out);
        if (stats && mUsed != &chosen)
            use(chosen);
        return stats;
    }
    [[nodiscard]] Result<VoxelizeStats> voxelizeWith(std::span<const GeometrySource> sources,
                                                     const GridTransform& transform,
                                                     const VoxelizeOptions& options,
                                                     std::span<VoxelGrid> grids) override {
        auto stats = mSlicemap->voxelizeWith(sources, transform, options, grids);
        if (stats && mUsed != mSlicemap.get())
            use(*mSlicemap);
        return stats;
    }
    [[nodiscard]] Result<SolidReport> downloadSolidReport() const override {
        return mUsed->downloadSolidReport();
    }

private:
    void use(Voxelizer& chosen) {
        mUsed = &chosen;
        setReason(*mDevice, std::string(name(chosen.backend())) + " serves " +
                                std::string(name(mCoverage)) + " coverage: it " +
                                (&chosen == mOverlap.get()
                                     ? "is exact and fast in orthographic grids with linear slices"
                                     : "takes every projection, slice distribution and split"));
    }

    std::shared_ptr<gl::DeviceState> mDevice;
    Coverage mCoverage;
    std::unique_ptr<Voxelizer> mOverlap;
    std::unique_ptr<Voxelizer> mSlicemap;
    Voxelizer* mUsed = nullptr; ///< By the last call that succeeded.
};

} // namespace

Result<std::unique_ptr<Voxelizer>> createAutomaticVoxelizer(const Device& device,
                                                            const VoxelizerDesc& desc) {
    auto overlap = createOverlapVoxelizer(device, desc);
    if (!overlap)
        return overlap;
    VoxelizerDesc mrt = desc;
    mrt.backend = Backend::MrtSlicemap;
    auto slicemap = createSlicemapVoxelizer(device, mrt);
    if (!slicemap)
        return slicemap;
    return std::unique_ptr<Voxelizer>(std::make_unique<AutomaticVoxelizer>(
        device.state(), desc.coverage, std::move(*overlap), std::move(*slicemap)));
}

} // namespace lamina
