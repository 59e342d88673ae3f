#include "sampler/sampler_description.h"

#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <array>
#include <charconv>
#include <variant>

namespace mitsuba::culling {
namespace {

/// The shortest digits that give the number back.
std::string digits(double number) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
    return {text.data(), end};
}

std::string error_bound(const Properties& properties) {
    constexpr const char* kName = "error_bound";
    if (properties.type(kName) == Properties::Type::String) {
        auto text = properties.get<std::string>(kName);
        if (text != "auto")
            Throw("lightcull_path: error_bound is \"%s\", wanted a number or \"auto\"", text);
        return text;
    }
    return digits(properties.get<double>(kName));
}

/// Throws for what make_sampler() would refuse.
void check(const std::string& description) {
    try {
        ::lightcull::parse_sampler(description);
    } catch (const ::lightcull::Error& error) {
        Throw("lightcull_path: %s", error.what());
    }
}

}  // namespace

std::string sampler_description(const Properties& properties) {
    const bool of_culled =
        properties.has_property("error_bound") || properties.has_property("sets");
    auto description =
        properties.get<std::string>("light_sampler", of_culled ? "culled" : "learned");
    if (properties.has_property("error_bound")) {
        description += ":error_bound=" + error_bound(properties);
    }
    if (properties.has_property("sets")) {
        description += ":sets=" + std::to_string(properties.get<int64_t>("sets"));
    }
    check(description);
    return description;
}

bool chooses_by_means(const std::string& description, std::size_t light_count,
                      std::size_t uncut_count) {
    if (light_count < 2) return true;
    const ::lightcull::SamplerSpec spec = ::lightcull::parse_sampler(description);
    if (const auto* bvh = std::get_if<::lightcull::LightBvhOptions>(&spec)) {
        return bvh->importance == ::lightcull::ClusterImportance::kMeans;
    }
    constexpr std::size_t kFew = 64;
    if (uncut_count > kFew) return false;
    if (const auto* culled = std::get_if<::lightcull::CulledOptions>(&spec)) {
        // All lights are accepted, unless their ranges are given.
        constexpr float kAllOfMore = 4.0f;
        return !culled->range.error_bound &&
               static_cast<float>(uncut_count) <= kAllOfMore * culled->range.expected_accepted;
    }
    return std::holds_alternative<::lightcull::LearnedOptions>(spec);
}

}  // namespace mitsuba::culling
