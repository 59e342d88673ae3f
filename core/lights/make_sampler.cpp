#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <charconv>
#include <string>
#include <vector>

#include "lights/set_count.h"

namespace lightcull {
namespace {

struct Option {
    std::string_view key, value;
};

/// "name:key=value:key=value", taken apart. Every option has to be taken by someone.
class Description {
  public:
    explicit Description(std::string_view text) : text_(text) {
        std::size_t begin = text.find(':');
        name = text.substr(0, begin);
        while (begin != std::string_view::npos) {
            const std::size_t end = text.find(':', ++begin);
            const std::string_view part = text.substr(begin, end - begin);
            const std::size_t equals = part.find('=');
            if (equals == std::string_view::npos) {
                fail("'" + std::string(part) + "' is no option: wanted KEY=VALUE");
            }
            options_.push_back({part.substr(0, equals), part.substr(equals + 1)});
            begin = end;
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error("sampler '" + std::string(text_) + "': " + what);
    }

    /// The value of the last option of that name, or nothing; it counts as taken.
    std::optional<std::string_view> take(std::string_view key) {
        std::optional<std::string_view> value;
        for (std::size_t i = options_.size(); i-- > 0;) {
            if (options_[i].key != key) continue;
            if (value) fail("option '" + std::string(key) + "' is given twice");
            value = options_[i].value;
            options_.erase(options_.begin() + static_cast<std::ptrdiff_t>(i));
        }
        return value;
    }
    template <typename Number>
    bool take_number(std::string_view key, Number& number) {
        const auto value = take(key);
        if (value) number = parse<Number>(key, *value);
        return value.has_value();
    }
    /// `chosen` becomes whether the value is `yes`, which or `no` it has to be.
    void take_choice(std::string_view key, std::string_view yes, std::string_view no,
                     bool& chosen) {
        const auto value = take(key);
        if (!value) return;
        if (*value != yes && *value != no) {
            fail(std::string(key) + " is '" + std::string(*value) + "', wanted " +
                 std::string(yes) + " or " + std::string(no));
        }
        chosen = *value == yes;
    }
    void check_all_taken() const {
        if (options_.empty()) return;
        fail("no option '" + std::string(options_.front().key) + "' for " + std::string(name));
    }

    template <typename Number>
    Number parse(std::string_view key, std::string_view value) const {
        Number number{};
        const char* end = value.data() + value.size();
        const auto result = std::from_chars(value.data(), end, number);
        if (result.ec != std::errc() || result.ptr != end) {
            fail(std::string(key) + " is '" + std::string(value) + "', wanted a number");
        }
        return number;
    }

    std::string_view name;

  private:
    std::string_view text_;
    std::vector<Option> options_;
};

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
    Description description(text);
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
