#pragma once

#include <type_traits>
#include <utility>

#include "lanes/light_tables.h"
#include "loop/light_bvh_arrays.h"
#include "paths/path_context.h"
#include "render/derivation.h"
#include "sampler/range_sets.h"
#include "wavefront/wavefront_passes.h"

namespace mitsuba::culling {

/// The paths of a render in variants of arrays.
template <typename Float, typename Spectrum>
struct LanePaths {
    WavefrontPasses<Float, Spectrum>& passes;
    const LightTables<Float, Spectrum>& tables;
    const LightBvhArrays<Float>* bvh;  ///< lights are chosen from it in the kernel; null: by
                                       ///< PathContext::light_sampler, between kernels
    const Derivation<Float, Spectrum>* derivation = nullptr;  ///< what is done in place of tracing
};

/// A task says what Integrator::sample() is to do, as far as its parameters do not. The thread that
/// calls sample() makes one, which holds for as long as it lives.
template <typename Float, typename Spectrum>
class RenderTask {
  public:
    /// The part of the render to trace: in scalar variants one path, named by its sets of ranges;
    /// in LLVM variants the next of the passes.
    using Part =
        std::conditional_t<dr::is_jit_v<Float>, const LanePaths<Float, Spectrum>, const PathSets>;

    RenderTask(const PathContext<Float, Spectrum>& context, Part& part)
        : context(context), part(part), previous_(std::exchange(current_, this)) {}
    ~RenderTask() { current_ = previous_; }
    RenderTask(const RenderTask&) = delete;
    RenderTask& operator=(const RenderTask&) = delete;

    /// The task of the calling thread; null if it has none.
    static const RenderTask* current() { return current_; }

    const PathContext<Float, Spectrum>& context;
    Part& part;

  private:
    const RenderTask* previous_;
    static thread_local const RenderTask* current_;
};
template <typename Float, typename Spectrum>
thread_local const RenderTask<Float, Spectrum>* RenderTask<Float, Spectrum>::current_ = nullptr;

}  // namespace mitsuba::culling
