// Renders one scene in four orders of work, and writes an image of each.
//
//     path_host [--width PIXELS] [--samples COUNT] [--threads COUNT]
//     path_host --compare [--samples COUNT] [--threads COUNT]

#include <lightcull/error.h>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "compare.h"
#include "host.h"

namespace host {
namespace {

struct Arguments {
    std::uint32_t width = 320, samples = 0, threads = 0;  // 0: not given
    bool compare = false;
};

[[noreturn]] void fail(const char* message) {
    std::fprintf(stderr, "path_host: %s\n", message);
    std::exit(2);
}

Arguments read_arguments(int count, char** values) {
    Arguments arguments;
    for (int i = 1; i < count; ++i) {
        const auto is = [&](const char* name) { return std::strcmp(values[i], name) == 0; };
        std::uint32_t* number = is("--width")     ? &arguments.width
                                : is("--samples") ? &arguments.samples
                                : is("--threads") ? &arguments.threads
                                                  : nullptr;
        if (is("--compare")) {
            arguments.compare = true;
        } else if (number == nullptr || i + 1 == count) {
            fail("wanted [--compare] [--width PIXELS] [--samples COUNT] [--threads COUNT]");
        } else {
            const long value = std::strtol(values[++i], nullptr, 10);
            if (value < 1 || value > 65536) fail("numbers are from 1 to 65536");
            *number = static_cast<std::uint32_t>(value);
        }
    }
    return arguments;
}

/// Writes a file of floats, from the bottom row up: a format that most viewers know.
void write_pfm(const char* path, const Film& film, const Job& job) {
    std::ofstream file(path, std::ios::binary);
    file << "PF\n" << job.width << ' ' << job.height << "\n-1.0\n";
    const float scale = 1.0f / static_cast<float>(job.end_sample - job.first_sample);
    for (std::uint32_t y = job.height; y-- > 0;) {
        for (std::uint32_t x = 0; x < job.width; ++x) {
            const float3 pixel = scale * film[std::size_t{y} * job.width + x];
            file.write(reinterpret_cast<const char*>(&pixel), sizeof pixel);
        }
    }
    if (!file) fail("an image could not be written");
}

void finish(const char* name, const char* path, const Film& film, const Job& job) {
    double sum = 0.0;
    for (const float3& pixel : film) sum += static_cast<double>(luminance(pixel));
    const double samples = static_cast<double>(job.end_sample - job.first_sample);
    std::printf("%-16s mean %.9f -> %s\n", name,
                sum / static_cast<double>(job.pixel_count()) / samples, path);
    write_pfm(path, film, job);
}

void render(const Scene& scene, const Job& job) {
    const auto pixels = static_cast<std::uint32_t>(job.pixel_count());
    {
        // The sampler is told how many pixels a pass serves, and chooses fewer sets for a small
        // image.
        const auto sampler = make_light_sampler(scene, lightcull::LearnedOptions{}, pixels);
        Film film(pixels);
        render_whole_passes(scene, *sampler, job, film);
        finish("whole passes", "whole_passes.pfm", film, job);
    }
    {
        // The sampler is not told, and so it has enough sets for all samples to come from one pass.
        const auto sampler = make_light_sampler(scene, lightcull::CulledOptions{}, 0);
        Film film(pixels);
        render_tiles(scene, *sampler, job, film);
        finish("tiles", "tiles.pfm", film, job);
    }
    {
        // Few sets, so that passes are cheap to make. No fewer, or all of a tile would share the
        // luck of a round.
        lightcull::CulledOptions options;
        options.set_count = 64;
        const auto sampler = make_light_sampler(scene, options, 0);
        Film film(pixels);
        render_tiles_in_rounds(scene, *sampler, job, film);
        finish("tiles in rounds", "tiles_in_rounds.pfm", film, job);
    }
    {
        const auto sampler = make_light_sampler(scene, lightcull::LearnedOptions{}, 0);
        Film film(pixels);
        render_tiles_as_it_learns(scene, *sampler, job, film);
        finish("tiles, learning", "tiles_learning.pfm", film, job);
    }
}

}  // namespace
}  // namespace host

int main(int count, char** values) {
    using namespace host;
    const Arguments arguments = read_arguments(count, values);
    const int threads = arguments.threads != 0 ? static_cast<int>(arguments.threads)
                                               : tbb::info::default_concurrency();
    // TBB starts no more threads than cores unless it is told to.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
    // lightcull works in the arena that it is called from.
    tbb::task_arena arena(threads);
    try {
        const Scene scene;
        arena.execute([&] {
            if (arguments.compare) {
                compare(scene, arguments.samples != 0 ? arguments.samples : 4096);
            } else {
                const std::uint32_t samples = arguments.samples != 0 ? arguments.samples : 64;
                render(scene, {arguments.width, arguments.width * 3 / 4, 0, samples});
            }
        });
    } catch (const lightcull::Error& error) {
        fail(error.what());
    }
}
