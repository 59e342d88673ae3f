#include "lights/light_groups.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "lights/range_tree.h"
#include "test_lights.h"

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
            const LightBvhPoint point(table.frame.position(shaded.position), Receiver(shaded));
            std::vector<bool> found(groups.groups.size());
            tree.for_each_accepted(point, shaded.set,
                                   [&](std::uint32_t group) { found[group] = true; });
            for (std::uint32_t g = 0; g < groups.groups.size(); ++g) {
                const Approach way = approach(point.position, groups.groups[g].center);
                if (!tree.accepts(g, shaded.set, way)) {
                    REQUIRE(!found[g]);
                } else if (importance(groups.groups[g], way, point) > 0.0f) {
                    REQUIRE(found[g]);
                    ++accepted;
                }
            }
        }
    }
    CHECK(accepted > 10000);
}
