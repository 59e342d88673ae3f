#pragma once

#include <lightcull/samplers.h>

#include <memory>

/// Makers of the samplers in this folder, of options that check_sampler() has passed.

namespace lightcull {

std::unique_ptr<LightSampler> make_uniform_sampler(Span<const Light> lights);
std::unique_ptr<LightSampler> make_power_sampler(Span<const Light> lights);
std::unique_ptr<LightSampler> make_exhaustive_sampler(Span<const Light> lights);
std::unique_ptr<LightSampler> make_light_bvh_sampler(const LightBvhOptions& options,
                                                     Span<const Light> lights);
std::unique_ptr<LightSampler> make_culled_sampler(const CulledOptions& options,
                                                  Span<const Light> lights,
                                                  const SamplerContext& context);
std::unique_ptr<LightSampler> make_learned_sampler(const LearnedOptions& options,
                                                   Span<const Light> lights,
                                                   const SamplerContext& context);

}  // namespace lightcull
