#include <doctest/doctest.h>
#include <hwy/highway.h>
#include <lightcull/instruction_set.h>
#include <lightcull/samplers.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

// Every user of Highway in the process shares hwy::GetChosenTarget().

namespace {

/// Selects by every instruction set in turn.
void select_by_all() {
    for (const std::string& name : instruction_sets()) {
        use_instruction_set(name);
        for (const char* description : {"culled", "light_bvh"}) {
            const auto sampler = make_sampler(description, mixed_lights(200, 1));
            sampler->begin_pass(0);
            const std::vector<ShadingPoint> points = mixed_points(40, 2, sampler->set_count());
            const std::vector<float> u(points.size(), 0.5f);
            std::vector<Selection> selections(points.size());
            sampler->select(points, u, selections);
            for (const ShadingPoint& point : points) {
                const Selection one = sampler->select(point, 0.5f);
                sampler->prob(point, one.receipt, 7);
            }
        }
    }
    use_instruction_set(instruction_sets().front());
}

}  // namespace

TEST_CASE("where nobody has used Highway yet, selections do not choose for the process") {
    hwy::GetChosenTarget().DeInit();
    select_by_all();
    CHECK(!hwy::GetChosenTarget().IsInitialized());
}

TEST_CASE("what others chose for the process stays, and does not bind selections") {
    std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    std::reverse(targets.begin(), targets.end());  // the worst first
    for (const std::int64_t target : targets) {
        hwy::GetChosenTarget().Update(target);
        const std::size_t index = hwy::GetChosenTarget().GetIndex();
        select_by_all();
        CHECK(hwy::GetChosenTarget().GetIndex() == index);
    }
    CHECK(instruction_sets().size() >= targets.size());
    hwy::GetChosenTarget().DeInit();
}
