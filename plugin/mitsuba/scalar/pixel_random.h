#pragma once

#include <mitsuba/core/random.h>
#include <mitsuba/render/sampler.h>

#include <cstdint>
#include <vector>

#include "paths/independent_sampler.h"

namespace mitsuba::culling {

/// The random numbers of each pixel in scalar variants, where a pass returns to a pixel for one
/// more sample.
///
/// A sampler of type `independent` is seeded anew each time. Any other sampler spreads the samples
/// of a pixel over all passes, which takes a sampler of its own for each pixel (some 100 bytes).
template <typename Float, typename Spectrum>
class PixelRandom {
  public:
    MI_IMPORT_TYPES(Sampler)

    PixelRandom(Sampler* prototype, std::uint32_t pixels, std::uint32_t seed)
        : prototype_(prototype), seed_(seed) {
        if (is_independent(prototype)) return;
        kept_.resize(pixels);
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
            kept_[pixel] = prototype->fork();
            kept_[pixel]->seed(seed * pixels + pixel);
        }
    }

    /// A sampler for a thread to hand to at().
    ref<Sampler> for_thread() const { return prototype_->fork(); }

    /// The sampler for a pixel in a pass; call advance() on it after each sample.
    Sampler* at(std::uint32_t pixel, std::uint32_t pass, Sampler* of_thread) const {
        if (!kept_.empty()) return const_cast<Sampler*>(kept_[pixel].get());
        of_thread->seed(sample_tea_32(seed_, pass).first + pixel);
        return of_thread;
    }

  private:
    Sampler* prototype_;
    std::uint32_t seed_;
    std::vector<ref<Sampler>> kept_;
};

}  // namespace mitsuba::culling
