#pragma once

#include <lightcull/light.h>
#include <lightcull/light_sampler.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mitsuba::culling {

/// All that a light sampler is made from.
struct SamplerInput {
    std::string description;
    std::vector<::lightcull::Light> lights;
    std::vector<::lightcull::ShadingPoint> points;  ///< to calibrate on
    std::uint32_t points_per_pass = 0;

    friend bool operator==(const SamplerInput& a, const SamplerInput& b);
};

/// A light sampler, and what it was made from: it serves every scene whose lights are the same,
/// seen from the same place, however that came about.
class MadeSampler {
  public:
    /// Runs in the caller's TBB arena. Throws lightcull::Error for what it cannot be made from.
    explicit MadeSampler(SamplerInput input);

    bool is_of(const SamplerInput& input) const { return input_ == input; }
    ::lightcull::LightSampler& sampler() const { return *sampler_; }

  private:
    SamplerInput input_;
    std::unique_ptr<::lightcull::LightSampler> sampler_;
};

}  // namespace mitsuba::culling
