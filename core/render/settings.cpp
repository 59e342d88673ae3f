#include "render/settings.h"

#include "render/scene_data.h"

#include <lightcull/error.h>

#include <cmath>
#include <string>

namespace lightcull {

void check_committed(const Scene& scene) {
    if (!data_of(scene).ray_tracer) throw Error("scene: commit() must come before rendering");
    if (data_of(scene).is_moved) {
        throw Error("scene: it was moved, and refit() must come before rendering");
    }
}

void check_settings(const RenderSettings& settings) {
    constexpr std::uint32_t kMost = 65535;
    if (settings.width < 1 || settings.width > kMost) {
        throw Error("settings: width is not in [1, 65535]");
    }
    if (settings.height < 1 || settings.height > kMost) {
        throw Error("settings: height is not in [1, 65535]");
    }
    if (settings.max_depth < 1) throw Error("settings: max_depth is 0: no path has no edge");
    if (settings.direct_light < DirectLight::kMis || settings.direct_light > DirectLight::kBsdf) {
        throw Error("settings: direct_light is unknown");
    }
    if (settings.threads > kMost) throw Error("settings: threads is above 65535");
}

void check_state(const RenderState& state, const RenderSettings& settings) {
    const std::size_t wanted = std::size_t{3} * settings.width * settings.height;
    if (state.sums.size() != wanted) {
        throw Error("state: has " + std::to_string(state.sums.size()) + " sums, not " +
                    std::to_string(wanted));
    }
    for (std::size_t i = 0; i < wanted; ++i) {
        if (!std::isfinite(state.sums[i])) {
            throw Error("state: sums[" + std::to_string(i) + "] is not finite");
        }
    }
    for (const double seconds :
         {state.stats.seconds, state.stats.sampler_seconds, state.stats.selection_seconds}) {
        if (!(seconds >= 0.0 && std::isfinite(seconds))) {
            throw Error("state: a number of seconds is negative or not finite");
        }
    }
}

}  // namespace lightcull
