#include "base/description.h"
#include "lights/spec/check_range_options.h"

#include <lightcull/error.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <cmath>
#include <string>

namespace lightcull {
namespace {

/// A value's name, and the value that it stands for.
template <typename Value>
struct Named {
    std::string_view name;
    Value value;
};

template <typename Value, std::size_t kCount>
void take_named(Description& description, std::string_view key,
                const Named<Value> (&choices)[kCount], Value& value) {
    const auto text = description.take(key);
    if (!text) return;
    std::string known;
    for (const Named<Value>& choice : choices) {
        if (choice.name == *text) {
            value = choice.value;
            return;
        }
        known += (known.empty() ? "" : ", ") + std::string(choice.name);
    }
    description.fail(std::string(key) + " is '" + std::string(*text) + "'; there are " + known);
}

void take_range(Description& description, RangeOptions& range) {
    if (const auto value = description.take("error_bound"); value && *value != "auto") {
        range.error_bound = description.parse<float>("error_bound", *value);
    }
    description.take_number("accepted", range.expected_accepted);
    description.take_number("exposure", range.exposure);
}

void take_culling(Description& description, VirtualLightOptions& options) {
    constexpr Named<VirtualLightCulling> kCullings[] = {
        {"tiles", VirtualLightCulling::kTiles}, {"splatting", VirtualLightCulling::kSplatting}};
    take_named(description, "culling", kCullings, options.culling);
    if (options.culling == VirtualLightCulling::kTiles) {
        description.take_number("tile", options.tile);
    }
}

void take_grid(Description& description, VirtualLightOptions& options) {
    constexpr Named<GridBuild> kBuilds[] = {{"gather", GridBuild::kGather},
                                            {"scatter", GridBuild::kScatter}};
    description.take_number("alpha", options.alpha);
    description.take_number("samples", options.shadow_samples);
    take_named(description, "build", kBuilds, options.grid_build);
}

void take_maps(Description& description, VirtualLightOptions& options) {
    description.take_number("points", options.map_points);
    description.take_choice("map_culling", "on", "off", options.map_culling);
}

void check_within(const char* name, std::uint32_t value, std::uint32_t least, std::uint32_t most) {
    if (value >= least && value <= most) return;
    throw Error(std::string(name) + " is not in [" + std::to_string(least) + ", " +
                std::to_string(most) + "]");
}

void check_grid(const VirtualLightOptions& options) {
    if (!(options.alpha > 0.0f && std::isfinite(options.alpha))) {
        throw Error("alpha is not finite and above 0");
    }
    check_within("samples", options.shadow_samples, 1, 1024);
}

void check_culling(const VirtualLightOptions& options) {
    check_range_options(options.range);
    if (options.culling == VirtualLightCulling::kTiles) {
        check_within("tile", options.tile, 1, 64);
    } else if (options.shadows != VirtualShadows::kNone) {
        throw Error("culling=splatting is for shadows=none");
    }
}

void check_maps(const VirtualLightOptions& options) {
    if (options.method == VirtualLightMethod::kGrid) {
        throw Error("shadows=maps is not for vpl_grid, whose lights have no maps");
    }
    check_within("points", options.map_points, 1, 1u << 20);
}

}  // namespace

void check_virtual_light_options(const VirtualLightOptions& options) {
    using Method = VirtualLightMethod;
    if (options.method == Method::kGrid) check_grid(options);
    if (options.method == Method::kCulled || options.method == Method::kClamped) {
        check_culling(options);
    }
    if (options.shadows == VirtualShadows::kMaps) check_maps(options);
    check_within("lights", options.light_paths, 1, 1u << 26);
    const auto edge = std::lround(std::sqrt(static_cast<double>(options.light_paths)));
    if (options.source == VirtualLightSource::kShadowMap && edge * edge != options.light_paths) {
        throw Error("lights: a shadow map has a square number of texels");
    }
    const std::uint32_t n = options.interleave;
    if (n != 1 && n != 2 && n != 4 && n != 8) throw Error("interleave is not 1, 2, 4 or 8");
}

VirtualLightOptions parse_virtual_light_method(std::string_view text) {
    using Method = VirtualLightMethod;
    constexpr Named<Method> kMethods[] = {{"vpl_all", Method::kAll},
                                          {"vpl_culled", Method::kCulled},
                                          {"vpl_clamped", Method::kClamped},
                                          {"vpl_grid", Method::kGrid}};
    constexpr Named<VirtualLightSource> kSources[] = {
        {"paths", VirtualLightSource::kPaths}, {"shadow_map", VirtualLightSource::kShadowMap}};
    constexpr Named<VirtualShadows> kShadows[] = {{"rays", VirtualShadows::kRays},
                                                  {"none", VirtualShadows::kNone},
                                                  {"maps", VirtualShadows::kMaps}};
    constexpr Named<BoundingVolume> kVolumes[] = {
        {"spheroid", BoundingVolume::kSpheroid},
        {"sphere_around", BoundingVolume::kSphereAround},
        {"sphere_at_light", BoundingVolume::kSphereAtLight}};

    Description description("method", text);
    VirtualLightOptions options;
    bool known = false;
    for (const auto& method : kMethods) {
        if (method.name != description.name) continue;
        options.method = method.value;
        known = true;
    }
    if (!known)
        description.fail("unknown; there are path, vpl_all, vpl_culled, vpl_clamped, vpl_grid");
    if (options.method == Method::kAll) {
        options.light_paths = 1024;
        options.interleave = 1;
        options.filter = false;
    }
    if (options.method == Method::kGrid) {
        take_grid(description, options);
    } else {
        description.take_number("interleave", options.interleave);
    }
    description.take_number("lights", options.light_paths);
    description.take_choice("filter", "on", "off", options.filter);
    take_named(description, "source", kSources, options.source);
    take_named(description, "shadows", kShadows, options.shadows);
    if (options.method == Method::kCulled || options.method == Method::kClamped) {
        take_range(description, options.range);
        take_culling(description, options);
    }
    if (options.method == Method::kCulled) {
        take_named(description, "volume", kVolumes, options.volume);
    }
    if (options.shadows == VirtualShadows::kMaps) take_maps(description, options);
    description.check_all_taken();
    try {
        check_virtual_light_options(options);
    } catch (const Error& error) {
        description.fail(error.what());
    }
    return options;
}

}  // namespace lightcull
