// Measures what image each order of work converges to, and how fast.

#include "compare.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <utility>

#include "host.h"

namespace host {
namespace {

constexpr std::uint32_t kWidth = 40, kHeight = 30;
constexpr std::size_t kPixelCount = std::size_t{kWidth} * kHeight;

/// A sampler that stays with one pass, whatever it is asked for: this is how it is when a host
/// forgets the others.
class OnePass final : public lightcull::LightSampler {
  public:
    OnePass(std::unique_ptr<lightcull::LightSampler> sampler, std::uint64_t number)
        : sampler_(std::move(sampler)), number_(number) {
        sampler_->begin_pass(number);
    }
    void begin_pass(std::uint64_t) override {}
    std::unique_ptr<const LightSelector> pass(std::uint64_t) const override {
        return sampler_->pass(number_);
    }
    lightcull::Selection select(const lightcull::ShadingPoint& point,
                                float u) const noexcept override {
        return sampler_->select(point, u);
    }
    void select(lightcull::Span<const lightcull::ShadingPoint> points,
                lightcull::Span<const float> u,
                lightcull::Span<lightcull::Selection> selections) const override {
        sampler_->select(points, u, selections);
    }
    float prob(const lightcull::ShadingPoint& point, const lightcull::Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return sampler_->prob(point, receipt, light);
    }
    std::uint32_t set_count() const noexcept override { return sampler_->set_count(); }

  private:
    std::unique_ptr<lightcull::LightSampler> sampler_;
    std::uint64_t number_;
};

using Order = void (*)(const Scene&, lightcull::LightSampler&, const Job&, Film&);

void whole_passes(const Scene& scene, lightcull::LightSampler& sampler, const Job& job,
                  Film& film) {
    render_whole_passes(scene, sampler, job, film);
}
void tiles(const Scene& scene, lightcull::LightSampler& sampler, const Job& job, Film& film) {
    render_tiles(scene, sampler, job, film);
}
void rounds(const Scene& scene, lightcull::LightSampler& sampler, const Job& job, Film& film) {
    render_tiles_in_rounds(scene, sampler, job, film);
}

void learning(const Scene& scene, lightcull::LightSampler& sampler, const Job& job, Film& film) {
    render_tiles_as_it_learns(scene, sampler, job, film);
}

struct Method {
    const char* name;
    Order order;
    const char* sampler;
    bool one_pass;
};

constexpr std::array<Method, 8> kMethods{
    {{"whole passes, 64 sets", whole_passes, "culled:sets=64", false},
     {"whole passes, learned", whole_passes, "learned", false},
     {"tiles, 4096 sets", tiles, "culled:sets=4096", false},
     {"tiles, a pass each 64 samples, 64 sets", tiles, "culled:sets=64", false},
     {"tiles, own pass each 16 samples, 64 sets", rounds, "culled:sets=64", false},
     {"tiles in rounds, learned", learning, "learned", false},
     {"tiles, but one pass of 64 sets", tiles, "culled:sets=64", true},
     {"whole passes, but begun once", whole_passes, "culled:sets=64", true}}};

/// The pixels where no lantern is seen. At the others the error is that of their edges, for any
/// sampler.
std::vector<std::size_t> pixels_without_lanterns(const Scene& scene) {
    std::vector<std::size_t> pixels;
    Random random(3);
    for (std::size_t pixel = 0; pixel < kPixelCount; ++pixel) {
        const std::size_t column = pixel % kWidth, row = pixel / kWidth;
        bool seen = false;
        for (int ray = 0; ray < 400 && !seen; ++ray) {
            const float x = static_cast<float>(column) + random.uniform();
            const float y = static_cast<float>(row) + random.uniform();
            const Hit hit = scene.intersect(
                scene.camera_ray((2.0f * x - kWidth) / kHeight, (kHeight - 2.0f * y) / kHeight));
            seen = hit.emitter != Hit::kNoEmitter || hit.distance == INFINITY;
        }
        if (!seen) pixels.push_back(pixel);
    }
    return pixels;
}

/// Two images of many samples, each with an error of its own.
struct Reference {
    std::vector<std::size_t> pixels;
    std::array<std::vector<double>, 2> images;
    double mean = 0.0;
};

std::vector<double> luminances(const Film& film, std::uint32_t samples,
                               const std::vector<std::size_t>& pixels) {
    std::vector<double> values;
    values.reserve(pixels.size());
    for (const std::size_t pixel : pixels) {
        values.push_back(static_cast<double>(luminance(film[pixel])) / samples);
    }
    return values;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

Reference make_reference(const Scene& scene, std::uint32_t samples) {
    Reference reference{pixels_without_lanterns(scene), {}, 0.0};
    const auto sampler = make_light_sampler(scene, lightcull::CulledOptions{}, kPixelCount);
    for (std::size_t i = 0; i < 2; ++i) {
        Film film(kPixelCount);
        render_whole_passes(scene, *sampler, {kWidth, kHeight, 0, samples, 1000 + i}, film);
        reference.images[i] = luminances(film, samples, reference.pixels);
        reference.mean += mean_of(reference.images[i]) / 2;
    }
    return reference;
}

/// The mean of the squared error over the squared truth. As the two references are independent,
/// their own error falls out of the mean of the product.
double relative_error(const std::vector<double>& image, const Reference& reference) {
    double sum = 0.0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        const double a = reference.images[0][i], b = reference.images[1][i];
        sum += (image[i] - a) * (image[i] - b) / (0.25 * (a + b) * (a + b) + 1e-4);
    }
    return sum / static_cast<double>(image.size());
}

struct Figures {
    double error = 0.0, mean = 0.0;
    int repeats = 0;
};

/// Renders with that many samples and adds to the figures at each of `stops` on the way.
void measure(const Scene& scene, const Method& method, std::uint64_t seed,
             const std::vector<std::uint32_t>& stops, const Reference& reference,
             std::vector<Figures>& figures) {
    auto sampler = make_light_sampler(scene, lightcull::parse_sampler(method.sampler), kPixelCount);
    if (method.one_pass) sampler = std::make_unique<OnePass>(std::move(sampler), mix(seed));
    Film film(kPixelCount);
    std::uint32_t done = 0;
    for (std::size_t i = 0; i < stops.size(); ++i) {
        method.order(scene, *sampler, {kWidth, kHeight, done, stops[i], seed}, film);
        done = stops[i];
        const std::vector<double> image = luminances(film, done, reference.pixels);
        figures[i].error += relative_error(image, reference);
        figures[i].mean += mean_of(image) / reference.mean - 1.0;
        ++figures[i].repeats;
    }
}

}  // namespace

void compare(const Scene& scene, std::uint32_t max_samples) {
    std::vector<std::uint32_t> stops;
    for (std::uint32_t samples = 16; samples <= max_samples; samples *= 4) stops.push_back(samples);
    const Reference reference = make_reference(scene, 2 * max_samples);
    std::printf("%zu of %zu pixels; error (relMSE), then the mean's difference, %%\n",
                reference.pixels.size(), kPixelCount);
    std::printf("%-42s", "samples of each pixel");
    for (const std::uint32_t samples : stops) std::printf(" %17u", samples);
    std::printf(" %10s\n", "us/sample");
    for (const Method& method : kMethods) {
        const std::clock_t begin = std::clock();
        std::vector<Figures> figures(stops.size());
        std::uint64_t samples = 0;
        // Few samples are rendered again and again, as one image of them says little.
        for (std::uint64_t repeat = 0; repeat < 8; ++repeat) {
            const std::size_t count = repeat < 2   ? stops.size()
                                      : repeat < 4 ? std::min(stops.size(), std::size_t{3})
                                                   : std::min(stops.size(), std::size_t{2});
            const std::vector<std::uint32_t> some(
                stops.begin(), stops.begin() + static_cast<std::ptrdiff_t>(count));
            measure(scene, method, repeat, some, reference, figures);
            samples += some.back() * kPixelCount;
        }
        std::printf("%-42s", method.name);
        for (const Figures& f : figures) {
            std::printf("  %.3e %+6.3f", f.error / f.repeats, 100.0 * f.mean / f.repeats);
        }
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        std::printf(" %10.2f\n", 1e6 * seconds / static_cast<double>(samples));
        std::fflush(stdout);
    }
}

}  // namespace host
