#include "loop/light_bvh_walk.h"

#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/light_bvh_table.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <vector>

#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;
namespace walk = mitsuba::culling::walk;

namespace {

struct Numbers {
    using Float = float;
    using Double = double;
    using UInt32 = std::uint32_t;
    using Mask = bool;
};

walk::Vec3<float> to_vec3(float3 v) {
    return {v.x, v.y, v.z};
}

/// The walk with plain numbers, as kernels do it with arrays.
class Walk {
  public:
    explicit Walk(const std::vector<Light>& lights) : table_(make_light_bvh_table(lights)) {}

    walk::Point<float> local(const ShadingPoint& point) const {
        const walk::Vec3<float> x =
            (to_vec3(point.position) - to_vec3(table_.origin)) * table_.inv_scale;
        walk::Point<float> local = walk::matte_point(x, to_vec3(point.normal));
        local.has_lobe = true;
        local.diffuse = point.diffuse;
        local.axis = to_vec3(point.lobe.axis);
        local.alpha2 = point.lobe.alpha * point.lobe.alpha;
        local.peak = point.lobe.peak;
        return local;
    }

    Selection select(const ShadingPoint& point, double place) const {
        walk::Descent<Numbers> descent{0, place, 1.0f};
        const walk::Point<float> x = local(point);
        while ((descent.child & LightBvhTable::kLight) == 0 && descent.prob > 0.0f) {
            walk::step_down<Numbers>(*this, x, true, descent);
        }
        return {descent.child & ~LightBvhTable::kLight, descent.prob, descent.prob, {}};
    }

    float prob(const ShadingPoint& point, std::uint32_t light) const {
        std::uint32_t cluster = table_.leaves[light];
        float prob = cluster == LightBvhTable::kNone ? 0.0f : 1.0f;
        const walk::Point<float> x = local(point);
        for (; cluster != LightBvhTable::kNone; cluster = table_.parents[cluster / 8]) {
            prob *= walk::prob_of_step<Numbers>(*this, x, cluster, true);
        }
        return prob;
    }

    // For the steps.
    static std::uint32_t width() { return LightBvhTable::kWidth; }
    walk::Cluster<float> cluster(std::uint32_t node, std::uint32_t i, bool) const {
        const LightBvhCluster& c = table_.clusters[node * LightBvhTable::kWidth + i];
        return {to_vec3(c.center), c.radius, c.spread, c.intensity,
                to_vec3(c.axis),   c.apex,   c.cosine, to_vec3(c.mean_normal),
                c.diffuse};
    }
    std::uint32_t child(std::uint32_t node, std::uint32_t i, bool) const {
        return table_.clusters[node * LightBvhTable::kWidth + i].child;
    }

  private:
    LightBvhTable table_;
};

/// Of the order of the sums, and of products of up to six levels.
constexpr float kRounding = 1e-5f;

std::vector<std::vector<Light>> scenes() {
    return {mixed_lights(2, 1), mixed_lights(8, 2), mixed_lights(700, 3),
            with_suns(mixed_lights(300, 4), 7)};
}

/// Some with a lobe, and some with the normal 0.
std::vector<ShadingPoint> points() {
    std::vector<ShadingPoint> points = mixed_points(60, 5, 1);
    RandomStream random(6);
    for (std::size_t i = 0; i < points.size(); i += 2) {
        points[i].diffuse = 0.3f;
        points[i].lobe = random_lobe(random);
    }
    return points;
}

}  // namespace

TEST_CASE("light BVH walk of the Mitsuba plugin: probabilities are those of light_bvh by means") {
    for (const std::vector<Light>& lights : scenes()) {
        const auto sampler = make_sampler("light_bvh:importance=means", lights);
        const Walk walk(lights);
        for (const ShadingPoint& point : points()) {
            for (std::uint32_t light = 0; light < lights.size(); ++light) {
                const float expected = sampler->prob(point, light);
                CHECK(std::abs(walk.prob(point, light) - expected) <= kRounding * expected);
            }
        }
    }
}

TEST_CASE(
    "light BVH walk of the Mitsuba plugin: lights have shares of numbers as their prob says") {
    constexpr std::uint32_t kPlaces = 4096;
    for (const std::vector<Light>& lights : scenes()) {
        const Walk walk(lights);
        for (const ShadingPoint& point : points()) {
            std::vector<int> counts(lights.size(), 0);
            bool found = true;
            for (std::uint32_t i = 0; found && i < kPlaces; ++i) {
                const Selection chosen = walk.select(point, (i + 0.5) / kPlaces);
                found = chosen.prob > 0.0f;
                if (!found) break;
                const float prob = walk.prob(point, chosen.light);
                CHECK(std::abs(chosen.prob - prob) <= kRounding * prob);
                ++counts[chosen.light];
            }
            for (std::uint32_t light = 0; found && light < lights.size(); ++light) {
                const auto share = static_cast<double>(walk.prob(point, light)) * kPlaces;
                CHECK(std::abs(counts[light] - share) < 1.01);
            }
        }
    }
}

TEST_CASE("make_light_bvh_table: no lights, dark lights and wrong ones") {
    CHECK(make_light_bvh_table({}).clusters.empty());
    std::vector<Light> lights = mixed_lights(3, 1);
    lights[1].intensity = 0.0f;
    const LightBvhTable table = make_light_bvh_table(lights);
    CHECK(table.leaves[1] == LightBvhTable::kNone);
    CHECK(table.parents == std::vector{LightBvhTable::kNone});
    CHECK(table.clusters.size() == LightBvhTable::kWidth);
    lights[2].intensity = -1.0f;
    CHECK_THROWS_AS(make_light_bvh_table(lights), Error);
}
