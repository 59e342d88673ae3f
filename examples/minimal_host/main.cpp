// A small renderer that lets lightcull choose its lights. It measures the noise of three samplers,
// at equal sample counts, against the sum over all lights, and writes the image of the sampler
// `culled`.

#include <lightcull/light.h>
#include <lightcull/samplers.h>
#include <lightcull/sets.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <vector>

#include "scene.h"

namespace host {

constexpr std::uint32_t kSamplesPerPixel = 16;

using Image = std::vector<float>;

/// lightcull never sees the geometry: only bounds, directions and strength of each light.
std::vector<lightcull::Light> describe_lights(const Scene& scene) {
    std::vector<lightcull::Light> lights;
    for (const Emitter& e : scene.emitters) {
        lights.push_back(lightcull::triangle_light(e.a, e.b, e.c, e.radiance));
    }
    return lights;
}

Image render(const Scene& scene, const std::vector<Hit>& hits, lightcull::LightSampler& sampler) {
    Image image(kPixelCount, 0.0f);
    Random random(1);
    for (std::uint32_t pass = 0; pass < kSamplesPerPixel; ++pass) {
        sampler.begin_pass(pass);
        for (const Hit& hit : hits) {
            const std::uint32_t set =
                lightcull::set_of_pixel(hit.x, hit.y, pass, sampler.set_count());
            const lightcull::Selection chosen =
                sampler.select({hit.point, hit.normal, set}, uniform(random));
            if (chosen.prob == 0.0f) continue;  // no light was chosen: a sample of 0
            const float light = light_from(scene, scene.emitters[chosen.light], hit, random);
            image[hit.y * kWidth + hit.x] += light / chosen.prob / kSamplesPerPixel;
        }
    }
    return image;
}

/// The light of every emitter, added up: what all samplers estimate.
Image render_all_lights(const Scene& scene, const std::vector<Hit>& hits) {
    Image image(kPixelCount, 0.0f);
    Random random(2);
    for (const Hit& hit : hits) {
        for (const Emitter& emitter : scene.emitters) {
            image[hit.y * kWidth + hit.x] += light_from(scene, emitter, hit, random);
        }
    }
    return image;
}

/// The mean of the squared error over the squared truth; 1e-4 keeps black pixels out of it.
double relative_error(const Image& image, const Image& truth) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double error = image[i] - truth[i];
        sum += error * error / (truth[i] * truth[i] + 1e-4);
    }
    return sum / static_cast<double>(image.size());
}

void write_pgm(const char* path, const Image& image) {
    std::ofstream file(path, std::ios::binary);
    file << "P5\n" << kWidth << ' ' << kHeight << "\n255\n";
    for (float value : image) {
        file.put(static_cast<char>(255.0f * std::pow(std::fmin(value, 1.0f), 1.0f / 2.2f)));
    }
}

}  // namespace host

int main() {
    using namespace host;
    const Scene scene = make_scene();
    const std::vector<Hit> hits = trace_camera_rays(scene);
    const std::vector<lightcull::Light> lights = describe_lights(scene);
    const auto uniform_sampler = lightcull::make_sampler(lightcull::UniformOptions{}, lights);
    const auto culled_sampler = lightcull::make_sampler(
        lightcull::CulledOptions{}, lights, {{}, static_cast<std::uint32_t>(hits.size())});
    const auto exhaustive_sampler = lightcull::make_sampler(lightcull::ExhaustiveOptions{}, lights);

    const Image image = render(scene, hits, *culled_sampler);
    write_pgm("minimal_host.pgm", image);
    const Image truth = render_all_lights(scene, hits);
    std::printf(
        "relative error at %u samples per pixel: uniform %.4f culled %.4f exhaustive %.4f\n",
        kSamplesPerPixel, relative_error(render(scene, hits, *uniform_sampler), truth),
        relative_error(image, truth),
        relative_error(render(scene, hits, *exhaustive_sampler), truth));
}
