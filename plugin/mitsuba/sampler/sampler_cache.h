#pragma once

#include <memory>
#include <mutex>
#include <utility>

#include "sampler/reusable_sampler.h"

namespace mitsuba::culling {

/// The cache keeps the light sampler of the last render for the next one, since samplers take long
/// to make. Any number of threads may use it; one of them gets what is there.
class SamplerCache {
  public:
    /// Gives away the sampler that is kept; null if there is none, or someone else has it.
    std::unique_ptr<ReusableSampler> take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return std::move(kept_);
    }
    /// Keeps a sampler in place of the one that is there.
    void keep(std::unique_ptr<ReusableSampler> sampler) {
        const std::lock_guard<std::mutex> lock(mutex_);
        kept_ = std::move(sampler);
    }

  private:
    std::mutex mutex_;
    std::unique_ptr<ReusableSampler> kept_;
};

}  // namespace mitsuba::culling
