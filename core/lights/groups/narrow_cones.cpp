#include "lights/groups/narrow_cones.h"

#include <cmath>

namespace lightcull {

double share_of_narrow_cones(Span<const Light> lights, float angle) noexcept {
    double narrow = 0.0, all = 0.0;
    for (const Light& light : lights) {
        if (light.directional) continue;
        const auto intensity = static_cast<double>(light.intensity);
        all += intensity;
        const bool may_be_narrow = light.cos_theta_o > 0.0f && light.lobe_alpha == 0.0f;
        if (may_be_narrow && std::acos(light.cos_theta_o) + std::acos(light.cos_theta_e) < angle) {
            narrow += intensity;
        }
    }
    return all > 0.0 ? narrow / all : 0.0;
}

}  // namespace lightcull
