#pragma once

#include <csignal>
#include <sys/resource.h>

namespace lamina::test {

/// Lets no file of this process grow past a size: what a full disk looks like, without one.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        mSignal = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &mBefore);
        const rlimit limit{bytes, mBefore.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &mBefore);
        std::signal(SIGXFSZ, mSignal);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit mBefore{};
    void (*mSignal)(int) = SIG_DFL;
};

} // namespace lamina::test
