#pragma once

// A path tracer that lets lightcull choose its lights, in four orders of work. host.cpp is what to
// read.

#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "scene.h"

namespace host {

/// A description of what to render: of an image of that size, some of the samples of each pixel.
struct Job {
    std::uint32_t width, height;
    std::uint32_t first_sample, end_sample;
    std::uint64_t seed = 0;  ///< jobs of different seeds are independent

    std::size_t pixel_count() const { return std::size_t{width} * height; }
};

/// The sum of the samples of each pixel, row by row from the top.
using Film = std::vector<float3>;

/// Makes a sampler. pixels_per_pass: the pixels of a host that begins a pass for each sample of the
/// image, else 0.
std::unique_ptr<lightcull::LightSampler> make_light_sampler(const Scene& scene,
                                                            const lightcull::SamplerSpec& spec,
                                                            std::uint32_t pixels_per_pass);

// Each function adds a job's samples to a film, to the same bits on any number of threads.

/// Renders all pixels at once, bounce by bounce, one sample after the other.
void render_whole_passes(const Scene& scene, lightcull::LightSampler& sampler, const Job& job,
                         Film& film);

/// Renders tile by tile, each with all its samples. All tiles select from the same passes.
void render_tiles(const Scene& scene, const lightcull::LightSampler& sampler, const Job& job,
                  Film& film);

/// Renders tile by tile, each with all its samples. A tile takes a pass of its own for every 16 of
/// them.
void render_tiles_in_rounds(const Scene& scene, const lightcull::LightSampler& sampler,
                            const Job& job, Film& film);

/// Renders tile by tile in rounds over the whole image, each of as many samples as those before,
/// for a sampler that learns.
void render_tiles_as_it_learns(const Scene& scene, lightcull::LightSampler& sampler, const Job& job,
                               Film& film);

}  // namespace host
