#include "virtual_lights/scene_checks.h"

#include <lightcull/error.h>

#include <string>

namespace lightcull {

void check_for_virtual_lights(const SceneData& scene) {
    if (!scene.virtual_lights.empty()) {
        throw Error("virtual lights: the scene has some among its lights already");
    }
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& m = scene.materials[i];
        if (m.kind == MaterialKind::kMetallicRoughness && m.roughness == 0.0f) {
            throw Error("virtual lights: material " + std::to_string(i) +
                        " has roughness 0: a perfect mirror sends light to single points, which "
                        "virtual lights cannot");
        }
    }
}

}  // namespace lightcull
