#include "sampler/sampler_description.h"

#include <array>
#include <charconv>
#include <string_view>

namespace mitsuba::culling {
namespace {

constexpr std::array<std::string_view, 4> kSamplers{"uniform", "power", "light_bvh", "culled"};

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

}  // namespace

std::string sampler_description(const Properties& properties) {
    auto description = properties.get<std::string>("light_sampler", "culled");
    if (std::find(kSamplers.begin(), kSamplers.end(), description) == kSamplers.end()) {
        Throw(
            "lightcull_path: no light_sampler \"%s\"; there are uniform, power, light_bvh, culled",
            description);
    }
    if (properties.has_property("error_bound")) {
        description += ":error_bound=" + error_bound(properties);
    }
    if (properties.has_property("sets")) {
        description += ":sets=" + std::to_string(properties.get<int64_t>("sets"));
    }
    return description;
}

}  // namespace mitsuba::culling
