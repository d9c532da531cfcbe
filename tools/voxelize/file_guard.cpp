#include "file_guard.hpp"

namespace lamina::tool {
namespace {

volatile std::sig_atomic_t sNotedSignal = 0;

extern "C" void noteSignal(int signal) {
    sNotedSignal = signal;
}

} // namespace

FileGuard::FileGuard() {
    sNotedSignal = 0;
    struct sigaction noting {};
    noting.sa_handler = noteSignal;
    noting.sa_flags = SA_RESTART;
    sigemptyset(&noting.sa_mask);
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
        sigaction(kSignals[i], nullptr, &mUsual[i]);
        // nohup and background shells ignore signals on purpose.
        if (mUsual[i].sa_handler != SIG_IGN)
            sigaction(kSignals[i], &noting, nullptr);
    }
}

FileGuard::~FileGuard() {
    for (std::size_t i = 0; i < kSignals.size(); ++i)
        sigaction(kSignals[i], &mUsual[i], nullptr);
    if (sNotedSignal != 0)
        std::raise(static_cast<int>(sNotedSignal));
}

bool FileGuard::isSignalled() const {
    return sNotedSignal != 0;
}

} // namespace lamina::tool
