#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <algorithm>

#include "base/description.h"
#include "lights/ranges/set_count.h"

namespace lightcull {
namespace {

void take_range_options(Description& description, const SamplerContext& context,
                        RangeOptions& range) {
    range.calibration_points = context.calibration_points;
    if (const auto value = description.take("error_bound")) {
        range.error_bound.reset();
        if (*value != "auto") range.error_bound = description.parse<float>("error_bound", *value);
    }
    description.take_number("accepted", range.expected_accepted);
    description.take_number("exposure", range.exposure);
}

std::unique_ptr<LightSampler> make_culled(Description& description, Span<const Light> lights,
                                          const SamplerContext& context) {
    CulledOptions options;
    take_range_options(description, context, options.range);
    options.set_count = suitable_set_count(lights.size(), context.points_per_pass);
    const bool has_glossy = std::any_of(lights.begin(), lights.end(),
                                        [](const Light& light) { return light.lobe_alpha > 0.0f; });
    // Their sets have spheres of their own, not radii alone: 55 bytes a light and set.
    constexpr std::uint32_t kSetsOfGlossy = 16;
    if (has_glossy) options.set_count = std::min(options.set_count, kSetsOfGlossy);
    description.take_number("sets", options.set_count);
    std::uint32_t group_size = 0;
    if (description.take_number("group", group_size)) options.group_size = group_size;
    description.check_all_taken();
    return make_culled_sampler(lights, options);
}

std::unique_ptr<LightSampler> make_paper(Description& description, Span<const Light> lights,
                                         const SamplerContext& context) {
    PaperOptions options;
    take_range_options(description, context, options.range);
    description.take_number("sets", options.set_count);
    description.take_choice("test", "vertex", "light", options.range_at_vertex);
    description.take_choice("weight", "g", "g_over_p", options.weight_by_g);
    description.take_number("list", options.list_size);
    description.check_all_taken();
    return make_paper_sampler(lights, options);
}

std::unique_ptr<LightSampler> make_clamped(Description& description, Span<const Light> lights,
                                           const SamplerContext& context) {
    RangeOptions options;
    take_range_options(description, context, options);
    description.check_all_taken();
    return make_clamped_sampler(lights, options);
}

std::unique_ptr<LightSampler> make_light_bvh(Description& description, Span<const Light> lights) {
    bool by_means = false;
    description.take_choice("importance", "means", "bounds", by_means);
    description.check_all_taken();
    return make_light_bvh_sampler(
        lights, {by_means ? ClusterImportance::kMeans : ClusterImportance::kBounds});
}

}  // namespace

std::unique_ptr<LightSampler> make_sampler(std::string_view text, Span<const Light> lights,
                                           const SamplerContext& context) {
    Description description("sampler", text);
    if (description.name == "culled") return make_culled(description, lights, context);
    if (description.name == "paper") return make_paper(description, lights, context);
    if (description.name == "clamped") return make_clamped(description, lights, context);
    if (description.name == "light_bvh") return make_light_bvh(description, lights);
    struct Plain {
        std::string_view name;
        std::unique_ptr<LightSampler> (*make)(Span<const Light>);
    };
    constexpr Plain kPlain[] = {{"uniform", make_uniform_sampler},
                                {"power", make_power_sampler},
                                {"exhaustive", make_exhaustive_sampler}};
    for (const Plain& plain : kPlain) {
        if (plain.name != description.name) continue;
        description.check_all_taken();
        return plain.make(lights);
    }
    description.fail(
        "unknown; there are uniform, power, light_bvh, exhaustive, clamped, culled, "
        "paper");
}

}  // namespace lightcull
