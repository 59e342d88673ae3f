#pragma once

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "sampler/sampler_input.h"

namespace mitsuba::culling {

/// A light sampler, and what it was made from: it serves every scene whose lights are the same,
/// seen from the same place, however that came about.
class ReusableSampler {
  public:
    /// Runs in the caller's TBB arena. Throws lightcull::Error for what it cannot be made from.
    explicit ReusableSampler(SamplerInput input);

    bool is_made_from(const SamplerInput& input) const { return input_ == input; }
    ::lightcull::LightSampler& sampler() const { return *sampler_; }
    /// Whether what it selects depends on what was reported to it.
    bool learns() const { return learns_; }
    /// Makes it select as a new one does, once a pass has begun.
    void forget();

  private:
    SamplerInput input_;
    std::unique_ptr<::lightcull::LightSampler> sampler_;
    bool learns_;
    std::vector<std::uint8_t> nothing_learned_;  ///< its state when it was made
};

}  // namespace mitsuba::culling
