#include <lightcull/samplers.h>

#include "lights/baselines/make_baselines.h"
#include "lights/samplers/make_samplers.h"

namespace lightcull {
namespace {

/// Makes the sampler that the options stand for with which it is called.
struct Maker {
    Span<const Light> lights;
    const SamplerContext& context;

    using Sampler = std::unique_ptr<LightSampler>;
    Sampler operator()(const UniformOptions&) const { return make_uniform_sampler(lights); }
    Sampler operator()(const PowerOptions&) const { return make_power_sampler(lights); }
    Sampler operator()(const ExhaustiveOptions&) const { return make_exhaustive_sampler(lights); }
    Sampler operator()(const LightBvhOptions& options) const {
        return make_light_bvh_sampler(options, lights);
    }
    Sampler operator()(const CulledOptions& options) const {
        return make_culled_sampler(options, lights, context);
    }
    Sampler operator()(const LearnedOptions& options) const {
        return make_learned_sampler(options, lights, context);
    }
    Sampler operator()(const PaperOptions& options) const {
        return make_paper_sampler(options, lights, context);
    }
    Sampler operator()(const ClampedOptions& options) const {
        return make_clamped_sampler(options, lights, context);
    }
};

}  // namespace

std::unique_ptr<LightSampler> make_sampler(const SamplerSpec& spec, Span<const Light> lights,
                                           const SamplerContext& context) {
    check_sampler(spec);
    return std::visit(Maker{lights, context}, spec);
}

std::unique_ptr<LightSampler> make_sampler(std::string_view description, Span<const Light> lights,
                                           const SamplerContext& context) {
    return make_sampler(parse_sampler(description), lights, context);
}

}  // namespace lightcull
