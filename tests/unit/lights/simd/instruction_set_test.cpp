#include <lightcull/instruction_set.h>

#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <doctest/doctest.h>
#include <tbb/task_arena.h>

#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "lights/baselines/culling_tree.h"
#include "unit/lights/simd/best_again.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

struct Results {
    std::vector<Selection> single, batch;
    std::vector<float> probs;  ///< probabilities of the light that the next point was given
};

std::unique_ptr<LightSampler> sampler_in_pass(const char* description,
                                              const std::vector<Light>& lights) {
    auto sampler = make_sampler(description, lights);
    sampler->begin_pass(4);
    return sampler;
}

Results run(const LightSampler& sampler, std::uint32_t point_count, int threads) {
    const auto points = mixed_points(point_count, 31, sampler.set_count());
    std::vector<float> u;
    for (std::size_t i = 0; i < points.size(); ++i) u.push_back(uniform_float(hash(i, 32)));
    Results results;
    results.batch.resize(points.size());
    tbb::task_arena(threads).execute([&] { sampler.select(points, u, results.batch); });
    for (std::size_t i = 0; i < points.size(); ++i) {
        results.single.push_back(sampler.select(points[i], u[i]));
        const std::uint32_t other = results.batch[(i + 1) % points.size()].light;
        results.probs.push_back(sampler.prob(points[i], results.single[i].receipt, other));
    }
    return results;
}

void require_equal(const std::vector<Selection>& a, const std::vector<Selection>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        REQUIRE(a[i].light == b[i].light);
        REQUIRE(a[i].prob == b[i].prob);
        REQUIRE(a[i].receipt.weight_sum == b[i].receipt.weight_sum);
        REQUIRE(a[i].receipt.key == b[i].receipt.key);
    }
}

}  // namespace

TEST_CASE("every instruction set, batch size and number of threads gives the scalar path's bits") {
    const BestAgain best_again;
    const std::vector<Light> lights = with_suns(mixed_lights(3000, 33, 8.0f), 100);
    CHECK(instruction_sets().back() == "scalar");
    for (const char* description :
         {"culled:sets=1", "culled:sets=16:accepted=4:group=1", "culled:sets=64:group=8",
          "culled:sets=4:group=40", "culled:sets=4:accepted=0.3:group=20", "light_bvh",
          "light_bvh:importance=means", "clamped", "exhaustive"}) {
        CAPTURE(description);
        constexpr std::uint32_t kPointCounts[] = {0, 1, 7, 8, 9, 17, repetitions(600, 100)};
        use_instruction_set("scalar");
        const auto by_scalar = sampler_in_pass(description, lights);
        std::vector<Results> expected;
        for (const std::uint32_t points : kPointCounts) {
            expected.push_back(run(*by_scalar, points, 1));
            require_equal(expected.back().batch, expected.back().single);
        }
        for (const std::string& name : instruction_sets()) {
            CAPTURE(name);
            use_instruction_set(name);
            CHECK(instruction_set() == name);
            const auto sampler = sampler_in_pass(description, lights);
            for (const Results& scalar : expected) {
                const auto points = static_cast<std::uint32_t>(scalar.single.size());
                CAPTURE(points);
                for (const int threads : {1, 2}) {
                    const Results results = run(*sampler, points, threads);
                    require_equal(results.single, scalar.single);
                    require_equal(results.batch, scalar.single);
                    CHECK(results.probs == scalar.probs);
                }
            }
        }
    }
}

TEST_CASE("every instruction set refits to the same radii, and walks the same nodes") {
    const BestAgain best_again;
    const LightTable table = make_light_table(with_suns(mixed_lights(5000, 34, 8.0f), 100));
    for (const std::uint32_t sets : {1u, 4u, 16u, 64u}) {
        const std::vector<ShadingPoint> points = mixed_points(100, 35, sets);
        CullingTree scalar(table, RandomRanges(1e-2f, sets));
        use_instruction_set("scalar");
        scalar.begin_pass(7);
        for (const std::string& name : instruction_sets()) {
            CAPTURE(name);
            use_instruction_set(name);
            CullingTree tree(table, RandomRanges(1e-2f, sets));
            tree.begin_pass(7);
            for (std::uint32_t set = 0; set < sets; ++set) {
                for (std::size_t slot = 0; slot < tree.tree().tree().slot_count(); ++slot) {
                    REQUIRE(tree.tree().radii(set)[slot] == scalar.tree().radii(set)[slot]);
                }
            }
            for (const ShadingPoint& point : points) {
                const auto count = [&](const CullingTree& t) {
                    return t.for_each_accepted(Receiver(t.frame(), point), point.set,
                                               [](const Accepted&) {});
                };
                const SelectionCounts a = count(tree), b = count(scalar);
                REQUIRE(a.nodes_visited == b.nodes_visited);
                REQUIRE(a.lights_tested == b.lights_tested);
                REQUIRE(a.accepted == b.accepted);
            }
        }
    }
}

TEST_CASE("an instruction set that is not there is refused, with those that are") {
    try {
        use_instruction_set("MMX");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(std::string(error.what()).find("'MMX'") != std::string::npos);
        CHECK(std::string(error.what()).find("scalar") != std::string::npos);
    }
    CHECK(instruction_set() == instruction_sets().front());
}
