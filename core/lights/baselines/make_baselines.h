#pragma once

#include <lightcull/samplers.h>

#include <memory>

/// Makers of the samplers in this folder, of options that check_sampler() has passed.

namespace lightcull {

std::unique_ptr<LightSampler> make_paper_sampler(const PaperOptions& options,
                                                 Span<const Light> lights,
                                                 const SamplerContext& context);
std::unique_ptr<LightSampler> make_clamped_sampler(const ClampedOptions& options,
                                                   Span<const Light> lights,
                                                   const SamplerContext& context);

}  // namespace lightcull
