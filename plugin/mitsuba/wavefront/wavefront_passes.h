#pragma once

#include <lightcull/light_sampler.h>

#include <mitsuba/core/random.h>
#include <mitsuba/render/film.h>
#include <mitsuba/render/imageblock.h>
#include <mitsuba/render/sampler.h>
#include <mitsuba/render/sensor.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "paths/independent_sampler.h"
#include "sampler/range_sets.h"
#include "wavefront/trace_wavefront.h"

namespace mitsuba::culling {

/// The passes of a render in LLVM variants: each takes some samples for every pixel, as one
/// wavefront. Where the light sampler learns, the first ones are smaller, so that it does so soon.
/// They stay equal, and small, with samplers that count on passes of one size.
template <typename Float, typename Spectrum>
class WavefrontPasses {
  public:
    MI_IMPORT_TYPES(Sensor, Film, ImageBlock, Sampler)

    /// What passes depend on of how lights are chosen.
    struct Choice {
        std::uint32_t range_sets = 1;  ///< set_count() of the light sampler
        bool learns = false;           ///< from pass to pass
        bool in_kernel = true;         ///< a pass is a single kernel
    };

    /// `size` is in pixels, with the border.
    WavefrontPasses(Sensor* sensor, const ScalarVector2u& size, std::uint32_t seed,
                    std::uint32_t spp, const Choice& choice,
                    const LightTables<Float, Spectrum>& tables, LaneMemory& memory)
        : film_(sensor->film()),
          sampler_(sensor->sampler()),
          block_(film_->create_block()),
          coalesce_(block_->coalesce()),
          size_(size),
          seed_(seed),
          keeps_random_(!choice.in_kernel || !is_independent(sampler_)),
          tables_(tables),
          memory_(memory) {
        const bool grows = choice.learns && is_independent(sampler_);
        const std::uint32_t most = choice.learns && !grows ? kMostSamplesLearning : kMostSamples;
        samples_ =
            samples_per_pass(std::min(kMostLanes / dr::prod(size), most), spp, choice.range_sets);
        first_samples_ = grows ? growing_parts(samples_) : std::vector{samples_};
        count_ = spp / samples_ - 1 + static_cast<std::uint32_t>(first_samples_.size());
        block_->set_offset(film_->crop_offset());
        pattern_ = {size.x(), 0, choice.range_sets};
        take_samples(first_samples_[0], seed);
    }

    std::uint32_t count() const { return count_; }
    /// The pass to be rendered next.
    WavefrontPass<Float, Spectrum> pass() {
        return {tables_, pattern_, memory_, sample_tea_32(seed_, done_).first};
    }
    Sampler* sampler() const { return sampler_; }
    ImageBlock* block() const { return const_cast<ImageBlock*>(block_.get()); }
    /// The corner of each lane's pixel on the film.
    const Vector2f& corners() const { return corners_; }

    /// Goes on to the next pass; call it after each.
    void advance() {
        ++done_;
        if (keeps_random_) {
            sampler_->advance();
            sampler_->schedule_state();
        }
        dr::eval(block_->tensor());
        dr::sync_thread();  // kernels read memory_
        const std::uint32_t samples =
            done_ < first_samples_.size() ? first_samples_[done_] : samples_;
        if (samples != pattern_.samples) {
            take_samples(samples, sample_tea_32(seed_, ~done_).first);
        } else if (!keeps_random_) {
            seed_sampler(sample_tea_32(seed_, ~done_).first);
        }
    }

    /// Puts the image on the film; call it after the last pass.
    void finish() { film_->put_block(block_); }

  private:
    /// This many lanes keep all threads busy, and fit into memory (some 500 bytes each).
    static constexpr std::uint32_t kMostLanes = 1u << 21;
    static constexpr std::uint32_t kMostSamples = 64;
    /// Where passes cannot grow, more would leave little to learn from.
    static constexpr std::uint32_t kMostSamplesLearning = 4;
    static constexpr std::uint32_t kFewestToCoalesce = 4;

    /// Passes take so many samples of a pixel from now on.
    void take_samples(std::uint32_t samples, std::uint32_t seed) {
        sampler_->set_samples_per_wavefront(samples);
        block_->set_coalesce(coalesce_ && samples >= kFewestToCoalesce);
        pattern_.samples = samples;
        seed_sampler(seed);
        const UInt32 pixel =
            dr::arange<UInt32>(dr::prod(size_) * samples) / dr::opaque<UInt32>(samples);
        Vector2i place;
        place.y() = Int32(pixel / size_.x());
        place.x() = Int32(pixel) - place.y() * Int32(size_.x());
        if (film_->sample_border()) place -= Int32(film_->rfilter()->border_size());
        place += Vector2i(film_->crop_offset());
        corners_ = Vector2f(place);  // computed in each kernel, rather than kept
    }

    /// Where the sampler is seeded anew for each pass, that is a part of the kernel, and nothing is
    /// kept of the lanes.
    void seed_sampler(std::uint32_t seed) {
        sampler_->seed(dr::opaque<UInt32>(seed), dr::prod(size_) * pattern_.samples);
        if (!keeps_random_) return;
        sampler_->schedule_state();
        dr::eval();
    }

    Film* film_;
    Sampler* sampler_;
    ref<ImageBlock> block_;
    bool coalesce_;
    ScalarVector2u size_;
    std::uint32_t seed_;
    bool keeps_random_;  ///< the state of the sampler goes from kernel to kernel
    const LightTables<Float, Spectrum>& tables_;
    LaneMemory& memory_;
    std::uint32_t samples_ = 1;                 ///< of a pixel in a pass
    std::vector<std::uint32_t> first_samples_;  ///< in each of the first passes
    std::uint32_t count_ = 1, done_ = 0;
    Vector2f corners_;
    SetPattern pattern_;
};

}  // namespace mitsuba::culling
