#include "subject.h"

#include "base/float3_math.h"
#include "base/random.h"
#include "courtyard.h"

#include <lightcull/sets.h>

#include <algorithm>
#include <cmath>

namespace lightcull::bench {
namespace {

/// Points uniform in the bounds of the lights, facing anywhere, in any order.
std::vector<ShadingPoint> uniform_points(const Subject& subject) {
    float3 low = subject.scene->lights()[0].center, high = low;
    for (const Light& light : subject.scene->lights()) {
        low = min(low, light.center);
        high = max(high, light.center);
    }
    RandomStream random(1);
    std::vector<ShadingPoint> points(std::size_t{settings().width} * settings().height);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const float3 size = high - low;
        const float x = random.next(), y = random.next(), z = random.next();
        points[i].position = low + float3{size.x * x, size.y * y, size.z * z};
        const float up = 2.0f * random.next() - 1.0f, turn = 6.2831853f * random.next();
        const float level = std::sqrt(std::max(0.0f, 1.0f - up * up));
        points[i].normal = {level * std::cos(turn), up, level * std::sin(turn)};
        points[i].set = set_of_packet(i / kPointsPerPacket, subject.sampler->set_count());
    }
    return points;
}

}  // namespace

std::shared_ptr<const Scene> courtyard(std::uint32_t light_count) {
    static std::uint32_t made_for = 0;
    static std::shared_ptr<const Scene> scene;
    if (made_for != light_count) {
        scene = make_courtyard(light_count);
        made_for = light_count;
    }
    return scene;
}

RenderSettings settings() {
    RenderSettings settings;
    settings.width = 640;
    settings.height = 480;
    settings.max_depth = 4;
    return settings;
}

Subject& subject(const std::string& description, std::uint32_t light_count) {
    static std::string made_for;
    static Subject subject;
    const std::string wanted = description + " " + std::to_string(light_count);
    if (made_for != wanted) {
        subject.scene = courtyard(light_count);
        subject.sampler = make_scene_sampler(description, *subject.scene, settings());
        subject.sampler->begin_pass(0);
        made_for = wanted;
    }
    return subject;
}

Points make_points(const Subject& subject, PointKind kind) {
    Points points;
    points.points = kind == PointKind::kUniform
                        ? uniform_points(subject)
                        : path_points(*subject.scene, settings(), *subject.sampler,
                                      1 + static_cast<std::uint32_t>(kind));
    RandomStream random(2);
    points.u.resize(points.points.size());
    for (float& u : points.u) u = random.next();
    return points;
}

}  // namespace lightcull::bench
