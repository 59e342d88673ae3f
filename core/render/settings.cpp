#include "render/settings.h"

#include "render/scene_impl.h"

#include <lightcull/error.h>

namespace lightcull {

void check_committed(const Scene& scene) {
    if (!scene.impl().ray_tracer) throw Error("scene: commit() must come before rendering");
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
    if (settings.threads > kMost) throw Error("settings: threads is above 65535");
}

}  // namespace lightcull
