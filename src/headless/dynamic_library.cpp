#include "headless/dynamic_library.hpp"

#include <dlfcn.h>

namespace lamina::headless {

DynamicLibrary::DynamicLibrary(const std::string& fileName)
    : mHandle(dlopen(fileName.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
    if (mHandle)
        return;
    const char* reason = dlerror();
    mError = reason ? reason : "not found";
}

void* DynamicLibrary::find(const char* symbol) const {
    return dlsym(mHandle, symbol);
}

} // namespace lamina::headless
