#pragma once

#include <drjit/morton.h>
#include <mitsuba/render/film.h>
#include <mitsuba/render/sensor.h>
#include <mitsuba/render/spiral.h>
#include <nanothread/nanothread.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "paths/progress_bar.h"
#include "sampler/range_sets.h"
#include "scalar/pixel_random.h"

namespace mitsuba::culling {

/// The passes of a render in scalar variants: each takes a few samples for every pixel, in blocks
/// over all threads.
template <typename Float, typename Spectrum>
class BlockPasses {
  public:
    MI_IMPORT_TYPES(Sensor, Film, ImageBlock, Sampler)

    /// A sample of a pixel.
    struct Pixel {
        std::uint32_t x, y;    ///< place among all that get samples, with the border
        Point2f corner;        ///< the pixel's corner on the film
        std::uint32_t sample;  ///< number of the sample in this pass
    };

    /// `film_size` is in pixels, with the border; a `block_size` of 0 stands for one that suits the
    /// threads; `range_sets` is the set_count() of the light sampler; `learns`: it learns from pass
    /// to pass.
    BlockPasses(Sensor* sensor, const ScalarVector2u& film_size, std::size_t channels,
                std::uint32_t block_size, std::uint32_t seed, std::uint32_t spp,
                std::uint32_t range_sets, bool learns)
        : film_(sensor->film()),
          film_size_(film_size),
          channels_(channels),
          block_size_(block_size != 0 ? block_size : suitable_block_size()),
          samples_(samples_per_pass(learns ? 1 : kMostSamples, spp, range_sets)),
          count_(spp / samples_),
          spiral_(new Spiral(film_size, film_->crop_offset(), block_size_, count_)),
          random_(sensor->sampler(), film_size.x() * film_size.y(), seed),
          progress_(std::uint64_t{spiral_->block_count()} * count_) {}

    std::uint32_t count() const { return count_; }

    /// Renders a pass: calls render(pixel, sampler, block, channels) for each sample of each pixel,
    /// until stop() is true.
    template <typename Render, typename Stop>
    void run(std::uint32_t pass, const Render& render, const Stop& stop) {
        const std::uint32_t blocks = spiral_->block_count();
        const std::uint32_t share = std::max(blocks / (16 * pool_size()), 1u);
        const dr::blocked_range<std::uint32_t> all(0, blocks, share);
        dr::parallel_for(all, [&](const auto& range) {
            ref<Sampler> sampler = random_.for_thread();
            ref<ImageBlock> block = film_->create_block(ScalarVector2u(block_size_), false, true);
            const std::unique_ptr<Float[]> channels(new Float[channels_]);
            for (auto i = range.begin(); i != range.end() && !stop(); ++i) {
                place_next(block.get());
                each_pixel(block.get(), [&](Pixel pixel) {
                    const std::uint32_t index = pixel.y * film_size_.x() + pixel.x;
                    Sampler* const random = random_.at(index, pass, sampler.get());
                    for (; pixel.sample < samples_ && !stop(); ++pixel.sample) {
                        render(pixel, random, block.get(), channels.get());
                        random->advance();
                    }
                });
                film_->put_block(block);
                progress_.step();
            }
        });
    }

  private:
    /// The most samples of a pixel in a pass. More would spare refits and waits for the last
    /// thread, and show the same ranges for longer. What learns does so soonest with one.
    static constexpr std::uint32_t kMostSamples = 4;

    /// The largest size of which every thread gets a block.
    std::uint32_t suitable_block_size() const {
        std::uint32_t size = MI_BLOCK_SIZE;
        while (size > 1 && dr::prod((film_size_ + size - 1) / size) < pool_size()) size /= 2;
        return size;
    }

    std::uint32_t border() const {
        return film_->sample_border() ? film_->rfilter()->border_size() : 0;
    }

    void place_next(ImageBlock* block) {
        const auto [offset, size, id] = spiral_->next_block();
        block->set_size(size);
        block->set_offset(offset - static_cast<std::int32_t>(border()));
        block->clear();
    }

    template <typename Function>
    void each_pixel(const ImageBlock* block, const Function& function) const {
        const ScalarPoint2i first =
            ScalarPoint2i(film_->crop_offset()) - static_cast<std::int32_t>(border());
        for (std::uint32_t i = 0; i < block_size_ * block_size_; ++i) {
            const Point2u inside = dr::morton_decode<Point2u>(i);
            if (dr::any(inside >= block->size())) continue;
            const Point2i corner = Point2i(inside) + block->offset();
            const Point2u place(corner - first);
            function({place.x(), place.y(), Point2f(corner), 0});
        }
    }

    Film* film_;
    ScalarVector2u film_size_;
    std::size_t channels_;
    std::uint32_t block_size_, samples_, count_;
    ref<Spiral> spiral_;
    PixelRandom<Float, Spectrum> random_;
    ProgressBar progress_;
};

}  // namespace mitsuba::culling
