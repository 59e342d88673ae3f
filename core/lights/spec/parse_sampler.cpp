#include <lightcull/samplers.h>

#include "base/description.h"

namespace lightcull {
namespace {

void take_range_options(Description& description, RangeOptions& range) {
    if (const auto value = description.take("error_bound")) {
        range.error_bound.reset();
        if (*value != "auto") range.error_bound = description.parse<float>("error_bound", *value);
    }
    description.take_number("accepted", range.expected_accepted);
    description.take_number("exposure", range.exposure);
}

void take_optional(Description& description, std::string_view key,
                   std::optional<std::uint32_t>& number) {
    std::uint32_t value = 0;
    if (description.take_number(key, value)) number = value;
}

CulledOptions take_culled(Description& description) {
    CulledOptions options;
    take_range_options(description, options.range);
    take_optional(description, "sets", options.set_count);
    take_optional(description, "group", options.group_size);
    return options;
}

LearnedOptions take_learned(Description& description) {
    LearnedOptions options;
    description.take_number("rounds", options.rounds);
    description.take_number("memory", options.memory_mib);
    return options;
}

PaperOptions take_paper(Description& description) {
    PaperOptions options;
    take_range_options(description, options.range);
    description.take_number("sets", options.set_count);
    description.take_choice("test", "vertex", "light", options.range_at_vertex);
    description.take_choice("weight", "g", "g_over_p", options.weight_by_g);
    description.take_number("list", options.list_size);
    return options;
}

ClampedOptions take_clamped(Description& description) {
    ClampedOptions options;
    take_range_options(description, options.range);
    return options;
}

LightBvhOptions take_light_bvh(Description& description) {
    bool by_means = false;
    description.take_choice("importance", "means", "bounds", by_means);
    return {by_means ? ClusterImportance::kMeans : ClusterImportance::kBounds};
}

SamplerSpec take_sampler(Description& description) {
    if (description.name == "culled") return take_culled(description);
    if (description.name == "learned") return take_learned(description);
    if (description.name == "paper") return take_paper(description);
    if (description.name == "clamped") return take_clamped(description);
    if (description.name == "light_bvh") return take_light_bvh(description);
    if (description.name == "uniform") return UniformOptions{};
    if (description.name == "power") return PowerOptions{};
    if (description.name == "exhaustive") return ExhaustiveOptions{};
    description.fail(
        "unknown; there are uniform, power, light_bvh, exhaustive, clamped, culled, "
        "learned, paper");
}

}  // namespace

SamplerSpec parse_sampler(std::string_view text) {
    Description description("sampler", text);
    const SamplerSpec spec = take_sampler(description);
    description.check_all_taken();
    check_sampler(spec);
    return spec;
}

}  // namespace lightcull
