#pragma once

#include <lightcull/render/renderer.h>

#include "arena.h"
#include "arrays.h"

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

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

/// A renderer for Python: one call at a time, without the GIL, and open to Ctrl-C.
template <typename AnyRenderer>
class Interruptible {
  public:
    /// make: gives the renderer; it is called in an arena of as many threads as the settings say.
    template <typename Make>
    Interruptible(const RenderSettings& settings, const Make& make) : settings_(settings) {
        using Clock = std::chrono::steady_clock;
        const Clock::time_point start = Clock::now();
        tbb::task_arena arena(arena_size(settings.threads));
        arena.execute([&] { renderer_ = make(); });
        setup_seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
    }

    bool render_pass() {
        return run_interruptibly(mutex_, [&](const std::atomic<bool>* cancel) {
            return renderer_->render_pass(cancel);
        });
    }

    pybind11::object image() {
        const std::vector<float3> pixels =
            locked([](const AnyRenderer& renderer) { return renderer.image(); });
        return array_from_image(pixels, settings_.width, settings_.height);
    }

    RenderStats stats() {
        return locked([](const AnyRenderer& renderer) { return RenderStats(renderer.stats()); });
    }

    double setup_seconds() const { return setup_seconds_; }

  protected:
    /// Calls action(renderer), while no other call is at work.
    template <typename Action>
    auto locked(const Action& action) {
        const pybind11::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return action(*renderer_);
    }

    const RenderSettings& settings() const noexcept { return settings_; }

  private:
    RenderSettings settings_;
    std::unique_ptr<AnyRenderer> renderer_;
    double setup_seconds_ = 0.0;
    std::mutex mutex_;
};

inline RenderSettings make_render_settings(std::uint32_t width, std::uint32_t height,
                                           std::uint32_t max_depth, std::uint64_t seed,
                                           std::uint32_t threads) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.max_depth = max_depth;
    settings.seed = seed;
    settings.threads = threads;
    return settings;
}

}  // namespace lightcull::python
