#include <doctest/doctest.h>
#include <lightcull/instruction_set.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/refine.h"
#include "lights/groups/group_kernels.h"
#include "lights/groups/light_groups.h"
#include "lights/ranges/range_tree.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

constexpr std::uint32_t kSets = 4096, kLights = 9;

/// Pairs of a point and a light at the edge of its range.
struct Pairs {
    std::uint64_t accepted = 0, refused = 0;
    std::uint64_t wrong = 0;  ///< pairs that only one of prob() and a traversal sees accepted

    Pairs operator+(const Pairs& other) const {
        return {accepted + other.accepted, refused + other.refused, wrong + other.wrong};
    }
};

/// Lights in more than one node, whose ranges end where rounding is coarse and where it is fine.
class Edges {
  public:
    Edges() : tree_(lights(), RandomRanges(3e-3f, kSets)) {}

    /// Compares, in one pass at one light, the distances around its range in every set.
    Pairs compare(std::uint64_t pass) {
        tree_.begin_pass(pass);
        RandomStream random(pass);
        const auto target = static_cast<std::uint32_t>(pass % kLights);
        const RangedLight& light = tree_.record(target);
        // All others weigh nothing, so that a weight is the target's.
        std::vector<LightGroup> groups(kLights);
        for (std::uint32_t i = 0; i < kLights; ++i) groups[i] = group_of(i, i == target);
        Pairs pairs;
        for (std::uint32_t set = 0; set < kSets; ++set) {
            const float3 way = random_direction(random);
            const float3 direction = way * (1.0f / length(way));
            const float range =
                tree_.ranges().range(light.intensity, tree_.ranges().xi(target, set));
            add(target, set, direction, range + light.radius, groups, pairs);
        }
        return pairs;
    }

  private:
    static std::vector<RangedLight> lights() {
        RandomStream random(81);
        std::vector<RangedLight> lights;
        for (std::uint32_t i = 0; i < kLights; ++i) {
            const float3 center = random_in_box(random, i % 3 == 0 ? 1e-6f : 1.0f);
            const float radius = i % 2 == 0 ? 0.0f : 0.1f * random.next();
            lights.push_back({center, radius, std::exp2(-10.0f * random.next())});
        }
        return lights;
    }

    LightGroup group_of(std::uint32_t i, bool lit) const {
        const RangedLight& light = tree_.record(i);
        LightGroup group{};
        group.center[0][0] = light.center.x;
        group.center[1][0] = light.center.y;
        group.center[2][0] = light.center.z;
        group.radius[0] = light.radius;
        group.cosine[0] = -2.0f;
        group.diffuse[0] = 1.0f;
        group.spread[0] = light.radius * light.radius;
        group.intensity[0] = lit ? light.intensity : 0.0f;
        return group;
    }

    /// Adds sixteen points, one ulp apart.
    void add(std::uint32_t target, std::uint32_t set, float3 direction, float distance,
             const std::vector<LightGroup>& groups, Pairs& pairs) const {
        const RangedLight& light = tree_.record(target);
        constexpr auto kSize = static_cast<int>(ReceiverPacket::kSize);
        constexpr int kMiddle = kSize / 2;
        const float ulp = std::nextafter(distance, 1e30f) - distance;
        ReceiverPacket packet(set);
        PacketRandom random;
        float3 points[ReceiverPacket::kSize];
        for (int i = 0; i < kSize; ++i) {
            const float at = distance + static_cast<float>(i - kMiddle) * ulp;
            points[i] = light.center + direction * at;
            packet.put(static_cast<std::size_t>(i), {points[i], float3{0, 0, 0}});
            random.u_bits[i] = float_bits(0.5f);
        }
        PacketChoice choice{};
        group_kernels().select_packet(tree_, groups.data(), packet, random, choice);
        for (std::size_t i = 0; i < ReceiverPacket::kSize; ++i) {
            const bool accepted = tree_.accepts(target, set, approach(points[i], light.center));
            const bool weighed = choice.weight_sum[i] > 0.0f;
            pairs.wrong += accepted == weighed ? 0 : 1;
            ++(accepted ? pairs.accepted : pairs.refused);
        }
        // One of the points is also asked by itself.
        const float3 x = points[set % ReceiverPacket::kSize];
        bool found = false;
        tree_.for_accepted(Receiver(x, float3{0, 0, 0}), set,
                           [&](Span<const std::uint32_t> records) {
                               for (const std::uint32_t record : records) found |= record == target;
                           });
        pairs.wrong += found == tree_.accepts(target, set, approach(x, light.center)) ? 0 : 1;
    }

    RangeTree tree_;
};

/// Compares so many pairs in all.
Pairs compare(std::uint64_t pair_count) {
    const std::uint64_t passes = pair_count / (kSets * ReceiverPacket::kSize) + 1;
    const tbb::blocked_range<std::uint64_t> all(0, passes, passes / 8 + 1);
    return tbb::parallel_reduce(
        all, Pairs{},
        [&](const tbb::blocked_range<std::uint64_t>& some, Pairs pairs) {
            Edges edges;
            for (std::uint64_t pass = some.begin(); pass != some.end(); ++pass) {
                pairs = pairs + edges.compare(pass);
            }
            return pairs;
        },
        [](const Pairs& a, const Pairs& b) { return a + b; });
}

}  // namespace

TEST_CASE("pairs at the edge of the range: what a traversal accepts, prob() accepts") {
    constexpr std::uint64_t kPairs = repetitions(100'000'000, 1'000'000);
    for (const std::string& name : instruction_sets()) {
        CAPTURE(name);
        use_instruction_set(name);
        const Pairs pairs = compare(kPairs);
        CHECK(pairs.accepted + pairs.refused >= kPairs);
        CHECK(pairs.accepted > kPairs / 5 * 2);
        CHECK(pairs.refused > kPairs / 5 * 2);
        CHECK(pairs.wrong == 0);
    }
    use_instruction_set(instruction_sets().front());
}
