#pragma once

#include <mitsuba/core/random.h>
#include <mitsuba/render/sampler.h>

#include <cstdint>

#include "paths/independent_sampler.h"

namespace mitsuba::culling {

/// The random numbers of the paths of a wavefront that are left.
///
/// A sampler of type `independent` is seeded anew for as many as are left. Any other sampler draws
/// for all paths that there ever were, since what each gets depends on what it got before.
template <typename Float, typename Spectrum>
class LaneRandom {
  public:
    MI_IMPORT_TYPES(Sampler)

    /// `seed` is that of the pass.
    LaneRandom(Sampler* sampler, std::uint32_t seed) : sampler_(sampler), seed_(seed) {}

    /// Draws from now on for the paths of `path`, those that are left after `depth` bounces.
    void keep(const UInt32& path, std::uint32_t depth) {
        path_ = path;
        compacted_ = dr::width(path) != sampler_->wavefront_size();
        if (!compacted_ || !is_independent(sampler_)) return;
        own_ = sampler_->fork();
        own_->seed(dr::opaque<UInt32>(sample_tea_32(seed_, depth).first),
                   static_cast<std::uint32_t>(dr::width(path)));
    }

    Float next_1d() { return own_ ? own_->next_1d() : of_paths(sampler_->next_1d()); }
    Point2f next_2d() { return own_ ? own_->next_2d() : of_paths(sampler_->next_2d()); }

    /// Marks for evaluation what makes the next numbers differ from these.
    void schedule() {
        if (!own_) sampler_->schedule_state();
    }

  private:
    template <typename Random>
    Random of_paths(const Random& all) const {
        if (!compacted_) return all;
        Random drawn = all;
        dr::eval(drawn);
        return dr::gather<Random>(drawn, path_);
    }

    Sampler* sampler_;
    ref<Sampler> own_;
    std::uint32_t seed_;
    UInt32 path_;
    bool compacted_ = false;
};

}  // namespace mitsuba::culling
