#include <lightcull/samplers.h>

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "gpu/device_sampler.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("a device refits radii to the processor's") {
    for (const char* description : {"culled:sets=16", "culled:group=1:sets=64", "culled:sets=1"}) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, mixed_lights(5'000, 74, 6.0f));
        const auto& culled = dynamic_cast<const CulledSamplerBase&>(*sampler);
        const CulledScene scene = culled.scene();
        const auto device = DeviceSampler::make(scene.frame, scene.tree, chooser_of(scene), {});
        for (const std::uint64_t pass : {0u, 7u}) {
            sampler->begin_pass(pass);
            const RangeTree& tree = scene.tree;
            device->refit(tree.ranges());
            const std::vector<float> radii = device->radii();
            const std::size_t slots = tree.tree().slot_count();
            REQUIRE(radii.size() == slots * tree.ranges().set_count());
            std::size_t different = 0;
            for (std::size_t i = 0; i < radii.size(); ++i) {
                const float expected = tree.radii(static_cast<std::uint32_t>(i / slots))[i % slots];
                different += radii[i] == expected ? 0 : 1;
            }
            MESSAGE(different << " of " << radii.size() << " radii differ");
            CHECK(different == 0);
        }
    }
}
