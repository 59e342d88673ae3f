#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>

#include <cstdint>
#include <memory>

namespace lightcull {

/// The base of a Sampler that chooses alike in every pass. Its copies share what it is made of.
template <typename Sampler>
class PasslessSampler : public LightSampler, public SamplerInfo {
  public:
    using LightSampler::select;

    void begin_pass(std::uint64_t) final {}
    std::unique_ptr<const LightSelector> pass(std::uint64_t) const final {
        return std::make_unique<Sampler>(static_cast<const Sampler&>(*this));
    }
};

}  // namespace lightcull
