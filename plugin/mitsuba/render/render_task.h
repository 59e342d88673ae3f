#pragma once

#include <type_traits>
#include <utility>

#include "paths/path_context.h"
#include "wavefront/wavefront_passes.h"

namespace mitsuba::culling {

/// What Integrator::sample() is to do, as far as its parameters do not say: set by the thread that
/// calls it, for as long as this lives.
template <typename Float, typename Spectrum>
class RenderTask {
  public:
    /// The sets of ranges of the one path, or the passes, of which there is one to trace.
    using Part =
        std::conditional_t<dr::is_jit_v<Float>, WavefrontPasses<Float, Spectrum>, const PathSets>;

    RenderTask(const PathSetup<Float, Spectrum>& setup, Part& part)
        : setup(setup), part(part), previous_(std::exchange(current_, this)) {}
    ~RenderTask() { current_ = previous_; }
    RenderTask(const RenderTask&) = delete;
    RenderTask& operator=(const RenderTask&) = delete;

    static const RenderTask* current() { return current_; }

    const PathSetup<Float, Spectrum>& setup;
    Part& part;

  private:
    const RenderTask* previous_;
    static thread_local const RenderTask* current_;
};
template <typename Float, typename Spectrum>
thread_local const RenderTask<Float, Spectrum>* RenderTask<Float, Spectrum>::current_ = nullptr;

}  // namespace mitsuba::culling
