#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <utility>

namespace lightcull::python {

/// Calls work(cancel) for its bool, without the GIL and open to Ctrl-C: Python's signal handlers
/// run in this thread only, so the work is done in another, under the lock of `mutex`.
template <typename Work>
bool run_interruptibly(std::mutex& mutex, Work&& work) {
    constexpr std::chrono::milliseconds kSignalPeriod{50};
    const pybind11::gil_scoped_release release;
    const std::lock_guard lock(mutex);
    std::atomic<bool> cancel{false};
    std::future<bool> done = std::async(std::launch::async, [&] { return work(&cancel); });
    bool interrupted = false;
    while (!interrupted && done.wait_for(kSignalPeriod) != std::future_status::ready) {
        const pybind11::gil_scoped_acquire acquire;
        interrupted = PyErr_CheckSignals() != 0;
    }
    if (interrupted) {
        cancel = true;
        done.wait();
        const pybind11::gil_scoped_acquire acquire;
        throw pybind11::error_already_set();
    }
    return done.get();
}

}  // namespace lightcull::python
