#include <doctest/doctest.h>
#include <lightcull/instruction_set.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>
#include <vector>

#include "lights/bvh/binary_light_tree.h"
#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_cluster.h"
#include "lights/bvh/light_bvh_descend.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/light/importance.h"
#include "unit/lights/light/importance_bound.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

constexpr std::size_t kWidth = LightBvhNode::kWidth;
constexpr double kPi = 3.14159265358979323846;

/// Icosahedra at random, each face a light: many scenes are made of such.
std::vector<Light> lanterns(std::uint32_t count, std::uint64_t seed) {
    constexpr float kGolden = 1.618034f;
    constexpr float3 kCorners[12] = {{-1, kGolden, 0},  {1, kGolden, 0},   {-1, -kGolden, 0},
                                     {1, -kGolden, 0},  {0, -1, kGolden},  {0, 1, kGolden},
                                     {0, -1, -kGolden}, {0, 1, -kGolden},  {kGolden, 0, -1},
                                     {kGolden, 0, 1},   {-kGolden, 0, -1}, {-kGolden, 0, 1}};
    RandomStream random(seed);
    std::vector<Light> lights;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 place = random_in_box(random, 1.0f);
        const float3 center{place.x * 10.0f, place.y * 2.0f, place.z * 10.0f};
        const float radius = 0.03f + 0.03f * random.next();
        const float radiance = std::exp(4.0f * random.next());
        for (int a = 0; a < 12; ++a) {
            for (int b = 0; b < 12; ++b) {
                for (int c = b + 1; a < b && c < 12; ++c) {
                    const float3 p = kCorners[a], q = kCorners[b], r = kCorners[c];
                    const auto is_edge = [](float3 v) { return dot(v, v) < 4.1f; };
                    if (!is_edge(p - q) || !is_edge(q - r) || !is_edge(r - p)) continue;
                    const bool outward = dot(cross(q - p, r - p), p) > 0.0f;
                    lights.push_back(triangle_light(center + p * radius,
                                                    center + (outward ? q : r) * radius,
                                                    center + (outward ? r : q) * radius, radiance));
                }
            }
        }
    }
    return lights;
}

template <typename Node>
constexpr LightBvhOptions kOptions{ClusterImportance::kMeans};
template <>
constexpr LightBvhOptions kOptions<BoundsNode>{ClusterImportance::kBounds};

Receiver local(const LightTable& table, const ShadingPoint& point) {
    return {table.frame, point};
}

template <typename Node>
LightBvhImportances importances(const Node& node, const Receiver& point) {
    LightBvhImportances result;
    light_bvh_kernels<Node>().importances(node, point, result.of);
    return result;
}

/// The probability of every light by a walk over the whole tree, and the probability that goes to
/// nodes none of whose lights can reach the point.
struct AllProbs {
    std::vector<double> of;
    double lost = 0.0;

    template <typename Node>
    AllProbs(const LightBvh<Node>& bvh, const Receiver& point) : of(bvh.slots.size()) {
        if (!bvh.nodes.empty()) walk(bvh, point, 0, 1.0);
    }
    template <typename Node>
    void walk(const LightBvh<Node>& bvh, const Receiver& point, std::uint32_t n, double prob) {
        const Node& node = bvh.nodes[n];
        const LightBvhImportances all = importances(node, point);
        const double sum = std::accumulate(all.of, all.of + kWidth, 0.0);
        if (sum == 0.0) lost += prob;
        for (std::size_t i = 0; i < kWidth; ++i) {
            if (all.of[i] == 0.0f) continue;
            const double share = prob * (static_cast<double>(all.of[i]) / sum);
            if ((node.child[i] & LightBvhNode::kLight) != 0) {
                of[node.child[i] & ~LightBvhNode::kLight] = share;
            } else {
                walk(bvh, point, node.child[i], share);
            }
        }
    }
};

bool is_light(std::uint32_t child) {
    return (child & LightBvhNode::kLight) != 0;
}

/// The longest path in nodes; checks on the way that each lit light has its slot and each node its
/// parent.
template <typename Node>
std::size_t check_links(const LightTable& table, const LightBvh<Node>& bvh) {
    std::vector<int> seen(table.records.size());
    std::vector<std::size_t> depth(bvh.nodes.size(), 1);
    std::size_t deepest = bvh.nodes.empty() ? 0 : 1;
    for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
        for (std::size_t i = 0; i < kWidth; ++i) {
            const std::uint32_t child = bvh.nodes[n].child[i];
            if (child == LightBvhNode::kEmpty) continue;
            if (is_light(child)) {
                ++seen[child & ~LightBvhNode::kLight];
                REQUIRE(bvh.slots[child & ~LightBvhNode::kLight] == kWidth * n + i);
            } else {
                REQUIRE(child > n);
                REQUIRE(bvh.parents[child] == kWidth * n + i);
                depth[child] = depth[n] + 1;
                deepest = std::max(deepest, depth[child]);
            }
        }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const bool lit = table.records[i].intensity > 0.0f;
        REQUIRE(seen[i] == (lit ? 1 : 0));
        if (!lit) REQUIRE(bvh.slots[i] == LightBvh<Node>::kNoSlot);
    }
    return deepest;
}

template <typename Node>
bool same_bytes(const LightBvh<Node>& a, const LightBvh<Node>& b) {
    return a.nodes.size() == b.nodes.size() && a.parents == b.parents && a.slots == b.slots &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof a.nodes[0]) == 0;
}

/// The direction at an angle from a cone's axis, on a random side of it.
float3 direction_in_cone(RandomStream& random, const EmissionCone& cone, float angle) {
    const float3 other = random_direction(random);
    float3 side = other - cone.axis * dot(other, cone.axis);
    side = side * (1.0f / length(side));
    const float sign = cone.two_sided && random.next() < 0.5f ? -1.0f : 1.0f;
    return (cone.axis * std::cos(angle) + side * std::sin(angle)) * sign;
}

bool holds(const EmissionCone& cone, float3 direction, float angle) {
    float cosine = std::max(-1.0f, dot(cone.axis, direction));
    if (cone.two_sided) cosine = std::abs(cosine);
    return std::acos(std::min(1.0f, cosine)) <= angle + 2e-3f;
}

/// The emission of Light's profile at an angle from the axis.
double profile(const EmissionCone& cone, double angle) {
    if (cone.two_sided) angle = std::min(angle, kPi - angle);
    const double from_normal = std::max(0.0, angle - static_cast<double>(cone.theta_o));
    return from_normal <= static_cast<double>(cone.theta_e) ? std::cos(from_normal) : 0.0;
}

/// The importance of a node's child by angles, in double precision, as an interval: between the
/// values for angles that are a little too large and a little too small.
struct PublishedImportance {
    double low, high;
    bool inside;

    PublishedImportance(const BoundsNode& node, std::size_t i, const Receiver& point) {
        const float3 way =
            float3{node.center[0][i], node.center[1][i], node.center[2][i]} - point.position;
        const double distance = std::sqrt(static_cast<double>(dot(way, way)));
        const auto radius = static_cast<double>(node.radius[i]);
        inside = distance <= radius;
        const double d = std::max(distance, 0.5 * radius);
        const double fall_off = static_cast<double>(node.intensity[i]) / (d * d);
        const auto angle_to = [&](float3 v) {
            const double cosine = static_cast<double>(dot(v, way)) / distance;
            return std::acos(std::max(-1.0, std::min(1.0, cosine)));
        };
        const float3 axis{node.axis[0][i], node.axis[1][i], node.axis[2][i]};
        double theta = kPi - angle_to(axis);
        if (std::signbit(node.cos_theta_e[i])) theta = std::min(theta, kPi - theta);
        const double theta_o = std::atan2(static_cast<double>(node.sin_theta_o[i]),
                                          static_cast<double>(node.cos_theta_o[i]));
        const double theta_e = std::acos(std::abs(static_cast<double>(node.cos_theta_e[i])));
        const double theta_u = inside ? kPi : std::asin(radius / distance);
        const double theta_i = point.from_all_sides > 0.0f ? 0.0 : angle_to(point.normal);
        const auto cosines = [&](double error) {
            const double emitter = std::max(0.0, theta - theta_o - theta_u + error);
            const double receiver = std::max(0.0, theta_i - theta_u + error);
            return emitter > theta_e ? 0.0 : std::cos(emitter) * std::max(0.0, std::cos(receiver));
        };
        constexpr double kError = 1e-3;
        low = fall_off * cosines(kError) * (1.0 - kError);
        high = fall_off * cosines(-kError) * (1.0 + kError);
    }
};

EmissionCone random_cone(RandomStream& random) {
    EmissionCone cone;
    cone.axis = random_direction(random);
    const float size = random.next();
    cone.set_theta_o(size < 0.2f ? 0.0f : 1.5f * size * size);
    cone.theta_e = 1.5707f * random.next();
    cone.two_sided = random.next() < 0.3f;
    return cone;
}

}  // namespace

TEST_CASE("light bvh: the orientation measure is the integral of the emission") {
    EmissionCone flat;
    flat.theta_e = static_cast<float>(kPi / 2);
    CHECK(orientation_measure(flat) == doctest::Approx(kPi));
    flat.two_sided = true;
    CHECK(orientation_measure(flat) == doctest::Approx(2 * kPi));
    RandomStream random(1);
    for (int i = 0; i < 50; ++i) {
        EmissionCone cone = random_cone(random);
        cone.two_sided = cone.two_sided && cone.theta() < 1.57f;
        double sum = 0.0;
        constexpr int kSteps = 20000;
        for (int k = 0; k < kSteps; ++k) {
            const double angle = (k + 0.5) * kPi / kSteps;
            sum += 2.0 * kPi * std::sin(angle) * profile(cone, angle) * kPi / kSteps;
        }
        CHECK(orientation_measure(cone) == doctest::Approx(sum).scale(0.0).epsilon(2e-3));
    }
}

TEST_CASE("light bvh: a merged cone holds the directions of both") {
    RandomStream random(2);
    for (int i = 0; i < 3000; ++i) {
        const EmissionCone a = random_cone(random);
        EmissionCone b = random_cone(random);
        if (i % 3 == 0) b.two_sided = a.two_sided;
        if (i % 7 == 0) b.axis = a.axis;
        if (i % 11 == 0) b.axis = -a.axis;
        const EmissionCone both = merge(a, b);
        CHECK(both.theta_e == std::max(a.theta_e, b.theta_e));
        CHECK(length(both.axis) == doctest::Approx(1.0f).scale(0.0).epsilon(1e-4));
        for (const EmissionCone& one : {a, b}) {
            for (int k = 0; k < 10; ++k) {
                const float angle = one.theta_o * (k == 0 ? 1.0f : random.next());
                REQUIRE(holds(both, direction_in_cone(random, one, angle), both.theta_o));
            }
        }
    }
}

TEST_CASE("light bvh: bounds and sums of clusters are those of their lights") {
    const LightTable table = make_light_table(mixed_lights(900, 3, 6.0f));
    const std::vector<BinaryLightNode> nodes = build_binary_light_tree(table);
    REQUIRE(nodes.size() == 2 * table.lit.size() - 1);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const LightCluster& cluster = nodes[n].cluster;
        double intensity = 0.0, flux = 0.0;
        double center[3] = {};
        std::size_t open = 1, i = n;
        // Depth-first order: a subtree ends when as many leaves as branches have passed.
        for (; open > 0; ++i) {
            if (!nodes[i].is_leaf()) {
                ++open;
                continue;
            }
            --open;
            const LightRecord& light = table.records[nodes[i].light];
            const LightCluster leaf = cluster_of(light);
            const double weight = static_cast<double>(light.intensity);
            intensity += weight;
            flux += weight * static_cast<double>(leaf.mean_emission);
            center[0] += weight * static_cast<double>(light.center.x);
            center[1] += weight * static_cast<double>(light.center.y);
            center[2] += weight * static_cast<double>(light.center.z);
            REQUIRE(length(light.center - cluster.center) + light.radius <=
                    cluster.radius * (1.0f + 1e-4f) + 1e-6f);
            const Box with_leaf{min(cluster.box.low, leaf.box.low),
                                max(cluster.box.high, leaf.box.high)};
            REQUIRE(length(with_leaf.high - cluster.box.high) == 0.0f);
            REQUIRE(length(with_leaf.low - cluster.box.low) == 0.0f);
            if (cluster.cone.theta_o < 3.0f) {
                REQUIRE(holds(cluster.cone, leaf.cone.axis, cluster.cone.theta_o));
            }
        }
        REQUIRE(static_cast<double>(cluster.intensity) ==
                doctest::Approx(intensity).scale(0.0).epsilon(1e-4));
        REQUIRE(static_cast<double>(cluster.mean_emission) ==
                doctest::Approx(flux / intensity).scale(0.0).epsilon(1e-4));
        REQUIRE(static_cast<double>(cluster.center.x) ==
                doctest::Approx(center[0] / intensity).scale(0.0).epsilon(1e-4));
        REQUIRE(static_cast<double>(cluster.center.y) ==
                doctest::Approx(center[1] / intensity).scale(0.0).epsilon(1e-4));
        REQUIRE(static_cast<double>(cluster.center.z) ==
                doctest::Approx(center[2] / intensity).scale(0.0).epsilon(1e-4));
        REQUIRE(length(cluster.mean_normal) <= 1.0f + 1e-5f);
    }
}

TEST_CASE_TEMPLATE(
    "light bvh: every lit light is in the tree once, whatever their number and place", Node,
    BoundsNode, MeansNode) {
    for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 63u, 65u, 1000u, 5000u}) {
        std::vector<Light> lights = mixed_lights(count, count);
        if (count > 8) lights[count / 2].intensity = 0.0f;
        const LightTable table = make_light_table(lights);
        const LightBvh<Node> bvh = build_light_bvh<Node>(table);
        CHECK(check_links(table, bvh) <= (count > 1000 ? 12 : 8));
        if (count <= 8) CHECK(bvh.nodes.size() == 1);

        for (Light& light : lights) light.center = {3, -2, 5};  // all in one place
        const LightTable heap = make_light_table(lights);
        CHECK(check_links(heap, build_light_bvh<Node>(heap)) <= 14);
    }
    CHECK(build_light_bvh<Node>(make_light_table(std::vector<Light>{})).nodes.empty());
}

TEST_CASE_TEMPLATE("light bvh: no tree is too deep", Node, BoundsNode, MeansNode) {
    // The best split takes a few lights off the far end, again and again: 59 deep if left alone.
    std::vector<Light> lights;
    for (int i = 0; i < 235; ++i) {
        const auto x = static_cast<float>(std::pow(0.93, i));
        lights.push_back(point_light({x, 0, 0}, static_cast<float>(std::pow(0.7, i))));
    }
    const LightTable table = make_light_table(lights);
    const std::vector<BinaryLightNode> binary = build_binary_light_tree(table);
    std::vector<int> depth(binary.size());
    for (std::size_t n = 0; n < binary.size(); ++n) {
        if (!binary[n].is_leaf()) depth[n + 1] = depth[binary[n].right] = depth[n] + 1;
    }
    CHECK(*std::max_element(depth.begin(), depth.end()) <= 40 + 8);
    check_links(table, build_light_bvh<Node>(table));
}

TEST_CASE("light bvh: lights that face one way go together") {
    // Two flat layers close together, the lower one facing down, the upper one up.
    RandomStream random(26);
    std::vector<Light> lights;
    lights.reserve(600);
    for (int i = 0; i < 600; ++i) {
        const bool lower = i % 3 == 0;
        const float x = random.next(), z = random.next();
        const float3 a{x, 0.25f * random.next() - (lower ? 0.3f : 0.0f), z};
        lights.push_back(triangle_light(a, a + float3{0.01f, 0, 0},
                                        a + float3{0, 0, lower ? 0.01f : -0.01f}, 1.0f));
    }
    const auto nodes = build_binary_light_tree(make_light_table(lights));
    CHECK(nodes[1].cluster.cone.theta_o < 0.05f);
    CHECK(nodes[nodes[0].right].cluster.cone.theta_o < 0.05f);
}

TEST_CASE_TEMPLATE("light bvh: nodes are full", Node, BoundsNode, MeansNode) {
    const LightBvh<Node> bvh = build_light_bvh<Node>(make_light_table(lanterns(500, 4)));
    std::size_t children = 0;
    for (const Node& node : bvh.nodes) {
        for (const std::uint32_t child : node.child) {
            children += child != LightBvhNode::kEmpty ? 1 : 0;
        }
    }
    CHECK(static_cast<double>(children) > 6.5 * static_cast<double>(bvh.nodes.size()));
}

TEST_CASE_TEMPLATE("light bvh: the tree is the same for one thread and many", Node, BoundsNode,
                   MeansNode) {
    const LightTable table = make_light_table(mixed_lights(20000, 5));
    LightBvh<Node> one;
    tbb::task_arena(1).execute([&] { one = build_light_bvh<Node>(table); });
    const LightBvh<Node> many = build_light_bvh<Node>(table);
    CHECK(same_bytes(one, many));
}

TEST_CASE_TEMPLATE(
    "light bvh: probabilities of all lights sum to one, and are those of select and prob", Node,
    BoundsNode, MeansNode) {
    for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 1000u}) {
        const std::vector<Light> lights = mixed_lights(count, 6 + count, 6.0f);
        const auto sampler = make_sampler(kOptions<Node>, lights);
        const LightTable table = make_light_table(lights);
        const LightBvh<Node> bvh = build_light_bvh<Node>(table);
        for (const ShadingPoint& point : mixed_points(100, 7, 1)) {
            const AllProbs all(bvh, local(table, point));
            const double sum = std::accumulate(all.of.begin(), all.of.end(), 0.0);
            REQUIRE(sum + all.lost == doctest::Approx(1.0).scale(0.0).epsilon(1e-12));
            for (std::uint32_t i = 0; i < count; ++i) {
                REQUIRE(sampler->prob(point, {}, i) == static_cast<float>(all.of[i]));
            }
            for (std::uint32_t k = 0; k < 20; ++k) {
                const Selection s = sampler->select(point, uniform_float(hash(k, 8)));
                if (s.prob == 0.0f) {
                    REQUIRE(s.light == 0);
                    REQUIRE(all.lost > 0.0);
                } else {
                    REQUIRE(s.prob == static_cast<float>(all.of[s.light]));
                }
            }
        }
    }
}

TEST_CASE_TEMPLATE("light bvh: where every light reaches, nothing is lost", Node, BoundsNode,
                   MeansNode) {
    RandomStream random(9);
    std::vector<Light> lights(500);
    for (Light& light : lights) {
        light = point_light(random_in_box(random, 1.0f), 0.1f + random.next());
    }
    const LightTable table = make_light_table(lights);
    const LightBvh<Node> bvh = build_light_bvh<Node>(table);
    for (ShadingPoint point : mixed_points(50, 10, 1)) {
        point.normal = {0, 0, 0};
        const AllProbs all(bvh, local(table, point));
        CHECK(all.lost == 0.0);
        for (const double prob : all.of) CHECK(prob > 0.0);
    }
}

TEST_CASE_TEMPLATE("light bvh: every light is selected as often as its probability says", Node,
                   BoundsNode, MeansNode) {
    constexpr int kDraws = 100000, kPoints = 3;
    constexpr std::uint32_t kLights = 120;
    const std::vector<Light> lights = mixed_lights(kLights, 11, 4.0f);
    // This limit gives one false alarm in 10,000 runs with other seeds.
    const double limit = sidak_z(1e-4, kPoints * (kLights + 1));
    const auto sampler = make_sampler(kOptions<Node>, lights);
    for (const ShadingPoint& point : mixed_points(kPoints, 12, 1)) {
        std::vector<int> chosen(kLights + 1);  // at the end: none chosen
        std::vector<double> prob(kLights + 1);
        for (std::uint64_t k = 0; k < kDraws; ++k) {
            const Selection s = sampler->select(point, uniform_float(hash(k, 13)));
            ++chosen[s.prob > 0.0f ? s.light : kLights];
        }
        prob[kLights] = 1.0;
        for (std::uint32_t i = 0; i < kLights; ++i) {
            prob[i] = static_cast<double>(sampler->prob(point, {}, i));
            prob[kLights] -= prob[i];
        }
        for (std::size_t i = 0; i <= kLights; ++i) {
            const double expected = kDraws * prob[i];
            if (expected < 20.0) {
                CHECK(chosen[i] < 80);  // such events are too rare for a normal distribution
            } else {
                const double spread = std::sqrt(expected * (1.0 - prob[i])) + 1e-6;
                CHECK(std::abs(chosen[i] - expected) / spread < limit);
            }
        }
    }
}

TEST_CASE_TEMPLATE(
    "light bvh: a light that can reach a point may be chosen, one that cannot is not", Node,
    BoundsNode, MeansNode) {
    // Powers so far apart that the means of clusters are those of their brightest light.
    std::vector<Light> lights = mixed_lights(2000, 14, 30.0f);
    for (std::size_t i = 0; i < lights.size(); i += 50) lights[i].intensity = 0.0f;
    const auto sampler = make_sampler(kOptions<Node>, lights);
    const LightTable table = make_light_table(lights);
    RandomStream random(15);
    std::vector<ShadingPoint> points = mixed_points(300, 16, 1);
    // Other points barely see a light over their horizon, or in its own.
    for (int k = 0; k < 300; ++k) {
        const auto i = static_cast<std::uint32_t>(2000.0f * random.next());
        const float3 x = random_in_box(random, 1.2f);
        const float3 way = lights[i].center - x;
        const float3 side = cross(way, random_direction(random));
        points.push_back({x, side * (1.0f / length(side)), 0});
        const float3 in_plane = cross(lights[i].axis, random_direction(random));
        points.push_back({lights[i].center + in_plane, random_direction(random), 0});
    }
    int reached = 0, not_reached = 0;
    for (const ShadingPoint& point : points) {
        const Receiver receiver(table.frame.position(point.position), point.normal);
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            const LightRecord& light = table.records[i];
            const Approach way = approach(receiver.position, light.center);
            const float prob = sampler->prob(point, {}, i);
            // Within these margins of a light's horizon, or of the point's, either may be right.
            LightRecord narrower = light, wider = light;
            narrower.sin_theta_e = static_cast<std::int16_t>(std::max(light.sin_theta_e - 40, 0));
            wider.radius += 0.02f * way.distance;
            const float peak = light.intensity / way.distance2;
            if (importance(narrower, way, receiver) > 1e-4f * peak) {
                ++reached;
                REQUIRE(prob > 0.0f);
            }
            // Bounds do not know that a flat light lies in a plane.
            const bool possible = std::is_same_v<Node, BoundsNode>
                                      ? importance_bound(wider, way, point.normal) > 0.0f
                                      : importance(wider, way, receiver) > 0.0f;
            if (!possible) {
                ++not_reached;
                REQUIRE(prob == 0.0f);
            }
        }
    }
    CHECK(reached > 100000);
    CHECK(not_reached > 100000);
}

TEST_CASE_TEMPLATE(
    "light bvh: a faint light that faces another way than its bright neighbours is seen", Node,
    BoundsNode, MeansNode) {
    RandomStream random(27);
    std::vector<Light> lights;
    lights.reserve(64);
    for (int i = 0; i < 63; ++i) {
        const float3 a = random_in_box(random, 0.1f);
        lights.push_back(triangle_light(a, a + float3{0, 0, 0.01f}, a + float3{0.01f, 0, 0}, 1e6f));
    }
    lights.push_back(triangle_light({0, 0, 0}, {0.01f, 0, 0}, {0, 0, 0.01f}, 1e-6f));
    const auto sampler = make_sampler(kOptions<Node>, lights);
    CHECK(lights[0].axis.y == doctest::Approx(1.0f));
    for (const float height : {0.2f, 1.0f, 10.0f, 1000.0f}) {
        CHECK(sampler->prob({{0, -height, 0}, {0, 1, 0}, 0}, {}, 63) > 0.0f);
        CHECK(sampler->prob({{0, -height, 0}, {0, 1, 0}, 0}, {}, 0) == 0.0f);
    }
}

TEST_CASE("light bvh: by means, lights of one node are chosen in proportion to importance") {
    const std::vector<Light> lights{triangle_light({-1, 0, 0}, {0, 0, 1.7f}, {1, 0, 0}, 3.0f),
                                    point_light({0, 3, 0}, 1.0f),
                                    spot_light({0, 4, 1}, {0, -1, 0}, 1.0f, 0.4f, 0.6f)};
    const LightTable table = make_light_table(lights);
    const auto sampler = make_sampler(kOptions<MeansNode>, lights);
    // The second point is close to the plane of the triangle, and to the triangle.
    for (const float3 x : {float3{0.3f, 2, 1}, float3{0.3f, 0.01f, 1.5f}, float3{2, 0.5f, 0}}) {
        float sum = 0.0f, shares[3];
        for (std::uint32_t i = 0; i < 3; ++i) {
            const LightRecord& light = table.records[i];
            const Receiver receiver(table.frame.position(x), float3{0, 0, 0});
            shares[i] = importance(light, approach(receiver.position, light.center), receiver);
            sum += shares[i];
        }
        for (std::uint32_t i = 0; i < 3; ++i) {
            const float share = shares[i] / sum;
            const float prob = sampler->prob({x, {0, 0, 0}, 0}, {}, i);
            CHECK(prob >= 0.7f * share);
            CHECK(prob <= 1.4f * share);
        }
    }
}

TEST_CASE("light bvh: by bounds, importance is what the paper's formula gives") {
    const LightTable table = make_light_table(mixed_lights(3000, 28, 6.0f));
    const LightBvh<BoundsNode> bvh = build_light_bvh<BoundsNode>(table);
    int above_zero = 0, zero = 0, inside = 0;
    for (const ShadingPoint& shading_point : mixed_points(200, 29, 1)) {
        const Receiver point(table.frame.position(shading_point.position), shading_point.normal);
        for (const BoundsNode& node : bvh.nodes) {
            const LightBvhImportances all = importances(node, point);
            for (std::size_t i = 0; i < kWidth; ++i) {
                const PublishedImportance expected(node, i, point);
                const auto found = static_cast<double>(all.of[i]);
                REQUIRE(found >= expected.low);
                REQUIRE(found <= expected.high);
                ++(found > 0.0 ? above_zero : zero);
                inside += expected.inside ? 1 : 0;
            }
        }
    }
    CHECK(above_zero > 10000);
    CHECK(zero > 10000);
    CHECK(inside > 1000);
}

TEST_CASE_TEMPLATE("light bvh: the least and the greatest u choose lights that reach", Node,
                   BoundsNode, MeansNode) {
    const LightTable table = make_light_table(mixed_lights(300, 17, 6.0f));
    const LightBvh<Node> bvh = build_light_bvh<Node>(table);
    for (const ShadingPoint& point : mixed_points(500, 18, 1)) {
        const AllProbs all(bvh, local(table, point));
        for (const double u : {0.0, 1e-300, 0x1p-53, 0.5, 1.0 - 0x1p-53}) {
            LightBvhDescent descent{local(table, point), u};
            light_bvh_kernels<Node>().descend(bvh, {&descent, 1});
            REQUIRE(descent.place >= 0.0);
            REQUIRE(descent.place < 1.0);
            if (is_light(descent.child)) {
                REQUIRE(descent.prob > 0.0);
                REQUIRE(descent.prob == all.of[descent.child & ~LightBvhNode::kLight]);
            } else {
                REQUIRE(descent.prob == 0.0);
                REQUIRE(all.lost > 0.0);
            }
        }
    }
}

TEST_CASE_TEMPLATE(
    "light bvh: lights of very different power and distance keep finite probabilities", Node,
    BoundsNode, MeansNode) {
    const std::vector<Light> lights{point_light({0, 0, 0}, 1e30f), point_light({1e6f, 0, 0}, 1e-6f),
                                    triangle_light({5, 0, 0}, {6, 0, 0}, {5, 1, 0}, 1e3f, true)};
    const auto sampler = make_sampler(kOptions<Node>, lights);
    for (const float3 x : {float3{0, 0, 0}, float3{1e-20f, 0, 0}, float3{1e6f, 0, 0},
                           float3{0, 1e12f, 0}, float3{5.3f, 0.3f, 0}}) {
        double sum = 0.0;
        for (std::uint32_t i = 0; i < 3; ++i) {
            const float prob = sampler->prob({x, {0, 0, 0}, 0}, {}, i);
            CHECK(std::isfinite(prob));
            sum += static_cast<double>(prob);
        }
        CHECK(sum == doctest::Approx(1.0));
    }
}

TEST_CASE_TEMPLATE("light bvh: all instruction sets choose alike, to the bit", Node, BoundsNode,
                   MeansNode) {
    const LightTable table = make_light_table(mixed_lights(3000, 19, 6.0f));
    const LightBvh<Node> bvh = build_light_bvh<Node>(table);
    const auto points = mixed_points(1000, 20, 1);
    const auto run = [&] {
        std::vector<LightBvhDescent> descents;
        for (std::size_t i = 0; i < points.size(); ++i) {
            descents.push_back(
                {local(table, points[i]), static_cast<double>(uniform_float(hash(i, 21)))});
            light_bvh_kernels<Node>().descend(bvh, {&descents[i], 1});
        }
        return descents;
    };
    const auto expected = run();
    for (const std::string& name : instruction_sets()) {
        use_instruction_set(name);
        const auto descents = run();
        for (std::size_t i = 0; i < points.size(); ++i) {
            REQUIRE(descents[i].child == expected[i].child);
            REQUIRE(descents[i].prob == expected[i].prob);
            REQUIRE(descents[i].place == expected[i].place);
        }
    }
    use_instruction_set(instruction_sets().front());
}

TEST_CASE_TEMPLATE("light bvh: counts are those of one way down", Node, BoundsNode, MeansNode) {
    const auto few =
        make_sampler(kOptions<Node>, std::vector<Light>(5, point_light({0, 1, 0}, 1.0f)));
    const SelectionCounts counts = sampler_info(*few)->count({{0, 0, 0}, {0, 1, 0}, 0});
    CHECK(counts.nodes_visited == 1);
    CHECK(counts.lights_tested == 5);
    CHECK(counts.accepted == 5);
    CHECK(sampler_info(*few)->count({{0, 0, 0}, {0, -1, 0}, 0}).accepted == 0);

    const auto many = make_sampler(kOptions<Node>, lanterns(500, 22));
    for (const ShadingPoint& point : mixed_points(100, 23, 1)) {
        const SelectionCounts c = sampler_info(*many)->count(point);
        CHECK(c.nodes_visited <= 10);
        CHECK(c.lights_tested <= 8 * c.nodes_visited);
        CHECK(c.accepted <= c.lights_tested);
    }
}

TEST_CASE_TEMPLATE("light bvh: the estimate of the light at a point has little variance", Node,
                   BoundsNode, MeansNode) {
    // The variance is that of the sum of all lights' unshadowed irradiance by one selection,
    // relative to its square.
    const std::vector<Light> lights = lanterns(500, 24);
    const LightTable table = make_light_table(lights);
    const LightBvh<Node> bvh = build_light_bvh<Node>(table);
    RandomStream random(25);
    double mean = 0.0;
    constexpr int kPoints = 100;
    for (int k = 0; k < kPoints; ++k) {
        const float3 place = random_in_box(random, 10.0f);
        const float3 x = table.frame.position({place.x, -2.2f, place.z});
        const float3 up{0, 1, 0};
        const AllProbs all(bvh, {x, up});
        double sum = 0.0, squares = 0.0;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const LightRecord& light = table.records[i];
            const float3 way = light.center - x;
            const float distance2 = dot(way, way);
            const float cosines =
                std::max(0.0f, -dot(lights[i].axis, way)) * std::max(0.0f, way.y) / distance2;
            if (!(cosines > 0.0f)) continue;
            const double given = static_cast<double>(light.intensity * cosines / distance2);
            sum += given;
            squares += given * given / all.of[i];
        }
        mean += (squares / (sum * sum) - 1.0) / kPoints;
    }
    CHECK(mean < (std::is_same_v<Node, BoundsNode> ? 1.3 : 0.4));
}
