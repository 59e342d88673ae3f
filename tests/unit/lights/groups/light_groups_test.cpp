#include "lights/groups/light_groups.h"

#include <doctest/doctest.h>
#include <lightcull/instruction_set.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "base/random.h"
#include "base/reservoir.h"
#include "lights/groups/group_kernels.h"
#include "lights/ranges/range_tree.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("groups hold every lit light once, and no more of them than they may") {
    std::vector<Light> lights = mixed_lights(3000, 41, 6.0f);
    lights[7].intensity = 0.0f;
    const LightTable table = make_light_table(lights);
    for (const std::uint32_t size : {1u, 7u, 64u, 5000u}) {
        const LightGroups groups = make_light_groups(table, size);
        std::vector<std::uint32_t> sizes(groups.groups.size());
        for (std::uint32_t i = 0; i < lights.size(); ++i) {
            REQUIRE((groups.group_of[i] == LightGroups::kNoGroup) == (i == 7));
            if (i != 7) ++sizes[groups.group_of[i]];
        }
        CHECK(*std::min_element(sizes.begin(), sizes.end()) >= 1);
        CHECK(*std::max_element(sizes.begin(), sizes.end()) <= size);
        if (size == 1) CHECK(sizes.size() == 2999);
        if (size == 64) CHECK(sizes.size() < 600);
    }
    CHECK(make_light_groups(make_light_table({}), 8).groups.empty());
}

TEST_CASE("the tree finds every group that a point accepts and that may reach it") {
    const LightTable table = make_light_table(mixed_lights(4000, 42, 8.0f));
    LightGroups groups = make_light_groups(table, 12);
    constexpr std::uint32_t kSets = 16;
    RangeTree tree(groups.ranged(), RandomRanges(2e-3f, kSets));
    groups.reorder(tree.tree().order);
    std::size_t accepted = 0;
    for (std::uint64_t pass = 0; pass < 20; ++pass) {
        tree.begin_pass(pass);
        for (const ShadingPoint& shaded : mixed_points(200, pass, kSets)) {
            const Receiver point(table.frame, shaded);
            std::vector<bool> found(groups.groups.size());
            tree.for_accepted(point, shaded.set, [&](Span<const std::uint32_t> records) {
                for (const std::uint32_t group : records) found[group] = true;
            });
            for (std::uint32_t g = 0; g < groups.groups.size(); ++g) {
                const Approach way = approach(point.position, groups.groups[g].position());
                if (!tree.accepts(g, shaded.set, way)) {
                    REQUIRE(!found[g]);
                } else if (importance(groups.groups[g], point) > 0.0f) {
                    REQUIRE(found[g]);
                    ++accepted;
                }
            }
        }
    }
    CHECK(accepted > 10000);
}

TEST_CASE("groups are weighed as a reservoir does it, one after the other") {
    const LightTable table = make_light_table(mixed_lights(3000, 42, 8.0f));
    LightGroups groups = make_light_groups(table, 12);
    RangeTree tree(groups.ranged(), RandomRanges(2e-3f, 1));
    groups.reorder(tree.tree().order);
    std::vector<std::uint32_t> records(groups.groups.size());
    std::iota(records.begin(), records.end(), 0u);
    for (const std::string& name : instruction_sets()) {
        CAPTURE(name);
        use_instruction_set(name);
        for (const ShadingPoint& shaded : mixed_points(100, 4, 1)) {
            const Receiver point(table.frame, shaded);
            const float u = uniform_float(hash(float_bits(shaded.position.x), 1));
            for (const std::size_t count : {1u, 7u, 16u, 17u, 100u}) {
                Reservoir reservoir(u);
                for (std::uint32_t i = 0; i < count; ++i) {
                    const float g = importance(groups.groups[i], point);
                    const Approach way = approach(point.position, groups.groups[i].position());
                    if (g > 0.0f) reservoir.add(i, g, g * tree.inverse_prob(i, way));
                }
                GroupChoice choice;
                group_kernels().weigh(tree, groups.groups.data(), {records.data(), count}, point,
                                      float_bits(u), choice);
                REQUIRE(choice.weight_sum == reservoir.weight_sum());
                if (!reservoir.chosen()) continue;
                REQUIRE(choice.record == reservoir.light());
                REQUIRE(choice.numerator / choice.weight_sum == reservoir.prob());
            }
        }
    }
    use_instruction_set(instruction_sets().front());
}

TEST_CASE("a height whose square underflows makes no importance negative") {
    const std::vector<Light> lights = {point_light({0, 0, 0}, 1), point_light({1, 1, 0}, 1)};
    const LightTable table = make_light_table(lights);
    const LightGroups groups = make_light_groups(table, 1);
    for (const std::string& name : instruction_sets()) {
        CAPTURE(name);
        use_instruction_set(name);
        for (const float slope : {1e-30f, -1e-30f, 1e-22f, -1e-22f}) {
            const ShadingPoint shaded{{0.5f, 0.25f, 0.0f}, {slope, 0, 1}};
            const Receiver point(table.frame, shaded);
            for (const LightGroup& group : groups.groups) CHECK(importance(group, point) >= 0.0f);
        }
    }
    use_instruction_set(instruction_sets().front());
}
