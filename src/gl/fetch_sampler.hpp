#pragma once

#include "gl/device_state.hpp"

namespace lamina::gl {

/// A sampler object for fetching texels of a host's texture: no comparison, no mipmaps, whatever
/// the texture itself says.
class FetchSampler {
public:
    explicit FetchSampler(std::shared_ptr<DeviceState> device)
        : mDevice(std::move(device)) {
        mDevice->gl.CreateSamplers(1, &mId);
        mDevice->gl.SamplerParameteri(mId, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        mDevice->gl.SamplerParameteri(mId, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    ~FetchSampler() { mDevice->gl.DeleteSamplers(1, &mId); }
    FetchSampler(const FetchSampler&) = delete;
    FetchSampler& operator=(const FetchSampler&) = delete;

    [[nodiscard]] GLuint id() const { return mId; }

private:
    std::shared_ptr<DeviceState> mDevice;
    GLuint mId = 0;
};

} // namespace lamina::gl
