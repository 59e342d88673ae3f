#include "sampler/reusable_sampler.h"

#include <lightcull/samplers.h>

#include <utility>

namespace mitsuba::culling {

ReusableSampler::ReusableSampler(SamplerInput input)
    : input_(std::move(input)),
      sampler_(::lightcull::make_sampler(input_.description, input_.lights,
                                         {input_.points, input_.points_per_pass})),
      learns_(sampler_->wants_reports()),
      nothing_learned_(sampler_->learned()) {
}

void ReusableSampler::forget() {
    if (learns_) sampler_->restore_learned(nothing_learned_);
}

}  // namespace mitsuba::culling
