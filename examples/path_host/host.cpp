#include "host.h"

#include <lightcull/checked_sampler.h>
#include <lightcull/sets.h>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "path.h"

namespace host {
namespace {

using lightcull::LightSampler;
using lightcull::LightSelector;
using lightcull::Selection;
using lightcull::ShadingPoint;

/// Tells a sampler that learns what a shadow ray found.
void tell(const LightSelector& pass, const ShadingPoint& point, const Selection& selection,
          float visibility) {
    const lightcull::LightOutcome outcome{point.position, point.normal, selection.receipt,
                                          selection.light, visibility};
    pass.report({&outcome, 1});
}

// Tile by tile.

/// One sample of a pixel, with lights from a pass that serves many samples.
float3 trace(const Scene& scene, const LightSelector& pass, const Job& job, std::uint32_t pixel,
             std::uint32_t sample) {
    Path path = start(scene, job, pixel, sample);
    const bool reports = pass.wants_reports();
    for (std::uint32_t bounce = 0; arrive(scene, pass, bounce, path); ++bounce) {
        // Each sample of a pixel takes another set. With the same set again and again, the image
        // would converge to a wrong one, as bright or dark at a pixel as that set happens to be.
        const std::uint32_t set = lightcull::set_of_sample(pixel % job.width, pixel / job.width,
                                                           sample, bounce, pass.set_count());
        const ShadingPoint point = shading_point(path, set);
        const Selection selection = pass.select(point, path.random.uniform());
        const auto visibility = add_light(scene, selection, path);
        if (reports && visibility) tell(pass, point, selection, *visibility);
        if (!leave(point, selection, path)) break;
    }
    return path.radiance;
}

/// Samples first to end of some pixels.
void add_samples(const Scene& scene, const LightSelector& pass, const Job& job,
                 const std::vector<std::uint32_t>& pixels, std::uint32_t first, std::uint32_t end,
                 Film& film) {
    for (const std::uint32_t pixel : pixels) {
        for (std::uint32_t sample = first; sample < end; ++sample) {
            film[pixel] = film[pixel] + trace(scene, pass, job, pixel, sample);
        }
    }
}

/// Calls render(tile, pixels) for all tiles of an image, on all threads.
template <typename Render>
void for_each_tile(const Job& job, Render render) {
    constexpr std::uint32_t kEdge = 16;
    const std::uint32_t across = (job.width + kEdge - 1) / kEdge;
    const std::uint32_t down = (job.height + kEdge - 1) / kEdge;
    tbb::parallel_for(std::uint32_t{0}, across * down, [&](std::uint32_t tile) {
        const std::uint32_t left = tile % across * kEdge, top = tile / across * kEdge;
        std::vector<std::uint32_t> pixels;
        for (std::uint32_t y = top; y < std::min(top + kEdge, job.height); ++y) {
            for (std::uint32_t x = left; x < std::min(left + kEdge, job.width); ++x) {
                pixels.push_back(y * job.width + x);
            }
        }
        render(tile, pixels);
    });
}

}  // namespace

void render_tiles(const Scene& scene, const LightSampler& sampler, const Job& job, Film& film) {
    // One pass serves as many samples as it has sets. All are made before, and never change, so
    // that all threads may select from them.
    const std::uint32_t samples_per_pass = sampler.set_count();
    std::vector<std::unique_ptr<const LightSelector>> passes(
        (job.end_sample + samples_per_pass - 1) / samples_per_pass);
    for (std::size_t i = job.first_sample / samples_per_pass; i < passes.size(); ++i) {
        passes[i] = sampler.pass(mix(job.seed) + i);
    }
    for_each_tile(job, [&](std::uint32_t, const std::vector<std::uint32_t>& pixels) {
        // Pass by pass, so that a core's cache holds the ranges of one at a time.
        for (std::uint32_t first = job.first_sample; first < job.end_sample;) {
            const std::uint32_t i = first / samples_per_pass;
            const std::uint32_t end = std::min((i + 1) * samples_per_pass, job.end_sample);
            add_samples(scene, *passes[i], job, pixels, first, end, film);
            first = end;
        }
    });
}

void render_tiles_in_rounds(const Scene& scene, const LightSampler& sampler, const Job& job,
                            Film& film) {
    constexpr std::uint32_t kSamplesPerRound = 16;
    for_each_tile(job, [&](std::uint32_t tile, const std::vector<std::uint32_t>& pixels) {
        for (std::uint32_t first = job.first_sample; first < job.end_sample;
             first += kSamplesPerRound) {
            // This pass is the tile's own. Any number of passes may be made and used at once.
            const std::uint64_t number = mix(mix(job.seed) + tile) + first / kSamplesPerRound;
            const std::unique_ptr<const LightSelector> pass = sampler.pass(number);
            const std::uint32_t end = std::min(first + kSamplesPerRound, job.end_sample);
            add_samples(scene, *pass, job, pixels, first, end, film);
        }
    });
}

void render_tiles_as_it_learns(const Scene& scene, LightSampler& sampler, const Job& job,
                               Film& film) {
    // All tiles end a round before the next begins: it is by what they found that it chooses.
    std::uint32_t end = job.first_sample;
    for (std::uint32_t first = end; first < job.end_sample; first = end) {
        end = std::min(std::max(2 * first, 1u), job.end_sample);
        sampler.begin_pass(mix(job.seed) + first);
        for_each_tile(job, [&](std::uint32_t, const std::vector<std::uint32_t>& pixels) {
            add_samples(scene, sampler, job, pixels, first, end, film);
        });
    }
}

// Whole passes.

namespace {

/// The place of a point on a Morton curve through the part of the scene that matters.
std::uint64_t place_on_curve(float3 point) {
    constexpr float kHalfEdge = 16.0f;
    const float3 scaled = 512.0f / kHalfEdge * point + float3{512, 512, 512};
    std::uint64_t place = 0;
    for (std::uint32_t bit = 10; bit-- > 0;) {
        for (const float along : {scaled.x, scaled.y, scaled.z}) {
            const auto cell = static_cast<std::uint32_t>(std::clamp(along, 0.0f, 1023.0f));
            place = (place << 1) | ((cell >> bit) & 1u);
        }
    }
    return place;
}

/// Puts the paths that are still under way in the order in which they lie in space.
void sort_along_curve(const std::vector<Path>& paths, std::vector<std::uint32_t>& alive) {
    std::vector<std::uint64_t> keys(alive.size());
    tbb::parallel_for(std::size_t{0}, alive.size(), [&](std::size_t i) {
        keys[i] = (place_on_curve(paths[alive[i]].position) << 32) | alive[i];
    });
    tbb::parallel_sort(keys);
    for (std::size_t i = 0; i < keys.size(); ++i) alive[i] = static_cast<std::uint32_t>(keys[i]);
}

/// Advances the paths `alive` by a step on all threads, and drops those that it ends.
template <typename Step>
void advance(std::vector<std::uint32_t>& alive, Step step) {
    constexpr std::uint32_t kEnded = 0xffffffffu;
    tbb::parallel_for(std::size_t{0}, alive.size(), [&](std::size_t i) {
        if (!step(i, alive[i])) alive[i] = kEnded;
    });
    alive.erase(std::remove(alive.begin(), alive.end(), kEnded), alive.end());
}

}  // namespace

void render_whole_passes(const Scene& scene, LightSampler& sampler, const Job& job, Film& film) {
    std::vector<Path> paths(job.pixel_count());
    std::vector<std::uint32_t> alive;
    std::vector<ShadingPoint> points;
    std::vector<float> u;
    std::vector<Selection> selections;
    for (std::uint32_t sample = job.first_sample; sample < job.end_sample; ++sample) {
        sampler.begin_pass(mix(job.seed) + sample);
        const bool reports = sampler.wants_reports();  // of a sampler that learns what is hidden
        alive.resize(paths.size());
        for (std::uint32_t pixel = 0; pixel < paths.size(); ++pixel) alive[pixel] = pixel;
        tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t pixel) {
            paths[pixel] = start(scene, job, static_cast<std::uint32_t>(pixel), sample);
        });
        for (std::uint32_t bounce = 0; !alive.empty(); ++bounce) {
            advance(alive, [&](std::size_t, std::uint32_t pixel) {
                return arrive(scene, sampler, bounce, paths[pixel]);
            });
            // Neighbours in the image take different sets: that is what hides the pattern. Later
            // bounces are sorted into packets that lie together and share a set, which makes their
            // selection faster.
            if (bounce > 0) sort_along_curve(paths, alive);
            points.resize(alive.size());
            u.resize(alive.size());
            selections.resize(alive.size());
            tbb::parallel_for(std::size_t{0}, alive.size(), [&](std::size_t i) {
                const std::uint32_t pixel = alive[i], sets = sampler.set_count();
                const auto packet = static_cast<std::uint32_t>(i / lightcull::kPointsPerPacket);
                const std::uint32_t set =
                    bounce == 0 ? lightcull::set_of_pixel(pixel % job.width, pixel / job.width,
                                                          sample, sets)
                                : lightcull::set_of_packet(packet, sets);
                points[i] = shading_point(paths[pixel], set);
                u[i] = paths[pixel].random.uniform();
            });
            sampler.select(points, u, selections);  // on all threads
            advance(alive, [&](std::size_t i, std::uint32_t pixel) {
                const ShadingPoint& point = points[i];
                const auto visibility = add_light(scene, selections[i], paths[pixel]);
                if (reports && visibility) tell(sampler, point, selections[i], *visibility);
                return leave(point, selections[i], paths[pixel]);
            });
        }
        for (std::size_t pixel = 0; pixel < paths.size(); ++pixel) {
            film[pixel] = film[pixel] + paths[pixel].radiance;
        }
    }
}

// Set-up.

std::unique_ptr<LightSampler> make_light_sampler(const Scene& scene,
                                                 const lightcull::SamplerSpec& spec,
                                                 std::uint32_t pixels_per_pass) {
    // lightcull never sees the geometry: only bounds, directions and strength of each light.
    std::vector<lightcull::Light> lights;
    for (const Emitter& e : scene.emitters()) {
        lights.push_back(lightcull::triangle_light(e.a, e.b, e.c, luminance(e.radiance)));
    }
    // The points are such as the image will ask for: where the camera rays of a small one arrive.
    // Rays from the camera ask for no probabilities, so any selector will do.
    const auto no_lights = lightcull::make_sampler(lightcull::UniformOptions{}, {});
    const Job small{24, 18, 0, 1};
    std::vector<ShadingPoint> typical;
    for (std::uint32_t pixel = 0; pixel < small.pixel_count(); ++pixel) {
        Path path = start(scene, small, pixel, 0);
        if (arrive(scene, *no_lights, 0, path)) typical.push_back(shading_point(path, 0));
    }
    auto sampler = lightcull::make_sampler(spec, lights, {typical, pixels_per_pass});
#ifndef NDEBUG
    // This sampler tells of points, sets and random numbers that make no sense, and of a pass
    // forgotten.
    sampler = lightcull::make_checked_sampler(std::move(sampler), lights.size());
#endif
    return sampler;
}

}  // namespace host
