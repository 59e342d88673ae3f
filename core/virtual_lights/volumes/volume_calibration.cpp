#include "virtual_lights/volumes/volume_calibration.h"

#include "lights/calibration/range_calibration.h"
#include "virtual_lights/volumes/bounding_volume.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kPoints = 128;

/// True if the light shines at a point, above the point's horizon.
bool reaches(const VirtualLight& light, const Receiver& receiver) noexcept {
    const V3f way = light.position - to_v3f(receiver.position);
    const V3f normal = to_v3f(receiver.normal);
    return light.normal.dot(way) < 0.0f && normal.dot(way) > 0.0f;
}

}  // namespace

float calibrate_reach(const std::vector<VirtualLight>& lights, const VirtualLightOptions& options,
                      const Scene& scene, const RenderSettings& settings) {
    const Frame metres;
    RangedScene ranged{metres, {}, [&](std::size_t i, const Receiver& receiver) {
                           if (!reaches(lights[i], receiver)) return RangedScene::kOutOfReach;
                           return (lights[i].position - to_v3f(receiver.position)).length();
                       }};
    ranged.lights.reserve(lights.size());
    for (const VirtualLight& light : lights) {
        ranged.lights.push_back({to_float3(light.position), 0.0f, intensity_bound(light)});
    }
    RangeOptions range = options.range;
    // Each pixel sees one of so many parts of the lights.
    range.expected_accepted *= static_cast<float>(options.interleave * options.interleave);
    const std::vector<ShadingPoint> points = camera_points(scene, settings, kPoints);
    const bool constant = options.method == VirtualLightMethod::kClamped;
    return calibrate_reach(ranged, range, points,
                           constant ? RangeLaw::kConstant : RangeLaw::kRandom);
}

}  // namespace lightcull
