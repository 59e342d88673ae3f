#include <lightcull/virtual_lights/scene_virtual_lights.h>

#include "base/random.h"
#include "render/scene_data.h"
#include "virtual_lights/paths/light_paths.h"
#include "virtual_lights/scene_checks.h"
#include "virtual_lights/tiles/tiled_lighting.h"
#include "virtual_lights/volumes/bounding_volume.h"

#include <lightcull/error.h>

#include <string>
#include <vector>

namespace lightcull {
namespace {

/// The light by which samplers know a virtual light.
Light light_of(const VirtualLight& light) noexcept {
    const float3 position = to_float3(light.position);
    if (light.lobe != Lobe::kGlossy) {
        return diffuse_point_light(position, to_float3(light.normal), intensity_bound(light));
    }
    return glossy_point_light(position, to_float3(unit(mirrored(light))), intensity_bound(light),
                              light.alpha);
}

/// A scene whose rays can be traced as long as this lives.
class Traceable {
  public:
    explicit Traceable(SceneData& scene) : scene_(scene) { make_traceable(scene); }
    ~Traceable() { scene_.ray_tracer.reset(); }
    Traceable(const Traceable&) = delete;
    Traceable& operator=(const Traceable&) = delete;

  private:
    SceneData& scene_;
};

std::vector<VirtualLight> trace(SceneData& scene, std::uint32_t light_paths, std::uint32_t bounces,
                                std::uint64_t seed) {
    const Traceable traceable(scene);
    const std::uint64_t key = hash(seed, std::uint64_t{0x7363656e65});
    const EmissionTable emission(scene);
    return virtual_lights(scene, emit(emission, light_paths, key), bounces, key);
}

void check_number(const char* name, std::uint32_t value, std::uint32_t least, std::uint32_t most) {
    if (value >= least && value <= most) return;
    throw Error(std::string("virtual lights: ") + name + " is " + std::to_string(value) +
                ", wanted " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace

void add_virtual_lights(Scene& scene, std::uint32_t light_paths, std::uint32_t bounces,
                        std::uint64_t seed) {
    constexpr std::uint32_t kMostPaths = 1u << 24;
    check_number("light_paths", light_paths, 1, kMostPaths);
    check_number("bounces", bounces, 1, 3);
    check_for_virtual_lights(data_of(scene));
    SceneData& impl = data_of(scene);
    std::vector<VirtualLight> lights = trace(impl, light_paths, bounces, seed);
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        impl.emitters.emplace_back(VirtualEmitter{i});
        impl.lights.push_back(light_of(lights[i]));
    }
    impl.virtual_nearest2 = nearest_distance2(lights);
    impl.virtual_lights = std::move(lights);
}

}  // namespace lightcull
