#include <doctest/doctest.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "unit/render/render_support.h"
#include "unit/test_lights.h"

/// These tests use samplers and renderers from several threads at once, in all the ways that the
/// interface allows, from threads and arenas of the host's. The results have the bits of one thread
/// alone; the thread sanitizer looks on.

using namespace render_support;
using namespace lightcull::testing;

namespace {

constexpr std::uint32_t kThreads = 16;
constexpr std::uint32_t kPoints = 600;

const char* const kSamplers[] = {"uniform",    "power",
                                 "light_bvh",  "light_bvh:importance=means",
                                 "exhaustive", "clamped",
                                 "culled",     "culled:group=1:sets=4",
                                 "paper",      "paper:list=0:sets=16:test=light"};

/// Calls run(0) to run(count - 1), each on a thread of its own.
void on_threads(std::uint32_t count, const std::function<void(std::uint32_t)>& run) {
    std::vector<std::thread> threads;
    for (std::uint32_t i = 0; i < count; ++i) threads.emplace_back(run, i);
    for (std::thread& thread : threads) thread.join();
}

std::vector<float> numbers(std::size_t count) {
    std::vector<float> u(count);
    for (std::size_t i = 0; i < count; ++i) u[i] = uniform_float(hash(i, 5));
    return u;
}

/// The answers of all const calls of a sampler at some points: of batches and single points.
struct Answers {
    std::vector<Selection> batch, single;
    std::vector<float> prob;
    std::vector<std::uint32_t> accepted;

    static Answers of(const LightSampler& sampler, std::uint32_t light_count) {
        const auto points = mixed_points(kPoints, 82, sampler.set_count());
        const auto u = numbers(points.size());
        Answers answers;
        answers.batch.resize(points.size());
        sampler.select(points, u, answers.batch);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Selection one = sampler.select(points[i], u[i]);
            answers.single.push_back(one);
            const auto other = static_cast<std::uint32_t>(hash(i, 6) % light_count);
            answers.prob.push_back(sampler.prob(points[i], one.receipt, other));
            answers.accepted.push_back(sampler_info(sampler)->count(points[i]).accepted);
        }
        return answers;
    }

    bool operator==(const Answers& other) const {
        return same(batch, other.batch) && same(single, other.single) && same(prob, other.prob) &&
               same(accepted, other.accepted);
    }

  private:
    template <typename T>
    static bool same(const std::vector<T>& a, const std::vector<T>& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
    }
};

Answers answers_of_pass(LightSampler& sampler, std::uint32_t light_count, std::uint64_t pass) {
    sampler.begin_pass(pass);
    return Answers::of(sampler, light_count);
}

std::shared_ptr<const Scene> lamps_over_floor(std::uint32_t lamps) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.7f));
    Shape floor, lights;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    for (std::uint32_t i = 0; i < lamps; ++i) {
        const auto x = static_cast<float>(i % 8) - 4.0f, z = static_cast<float>(i / 8) - 4.0f;
        lights.add_level_square({x, 2.0f, z}, 0.1f, false);
    }
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(lights.mesh("lights", 0, emission(10.0f)));
    scene->set_camera(look({0, 1.5f, 5}, {0, 0.7f, 0}, 0.9f));
    return committed(scene);
}

std::vector<float3> render(const std::shared_ptr<const Scene>& scene, const char* sampler) {
    RenderSettings settings = square_image(72, 4);  // more than one tile
    settings.threads = 3;
    Renderer renderer(scene, settings, make_scene_sampler(sampler, *scene, settings));
    for (int pass = 0; pass < 3; ++pass) renderer.render_pass();
    return renderer.image();
}

bool same_bits(const std::vector<float3>& a, const std::vector<float3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float3)) == 0;
}

}  // namespace

TEST_CASE("threads: sixteen of them ask one sampler") {
    const std::vector<Light> lights = mixed_lights(300, 81, 5.0f);
    for (const char* description : kSamplers) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, lights);
        const Answers alone = answers_of_pass(*sampler, 300, 3);
        std::vector<Answers> answers(kThreads);
        on_threads(kThreads, [&](std::uint32_t i) { answers[i] = Answers::of(*sampler, 300); });
        for (const Answers& a : answers) CHECK(a == alone);
    }
}

TEST_CASE("threads: passes begin while nobody selects, each on another thread") {
    const std::vector<Light> lights = mixed_lights(300, 81, 5.0f);
    for (const char* description : {"culled", "paper:sets=4", "light_bvh"}) {
        CAPTURE(description);
        const auto sampler = make_sampler(description, lights);
        for (const std::uint64_t pass : {5u, 6u, 5u}) {
            std::thread([&] { sampler->begin_pass(pass); }).join();
            std::vector<Answers> answers(4);
            on_threads(4, [&](std::uint32_t i) { answers[i] = Answers::of(*sampler, 300); });
            const auto fresh = make_sampler(description, lights);
            const Answers expected = answers_of_pass(*fresh, 300, pass);
            for (const Answers& a : answers) CHECK(a == expected);
        }
    }
}

TEST_CASE("threads: samplers are built, refitted and asked at once") {
    const std::vector<Light> lights = mixed_lights(3000, 81, 5.0f);
    for (const char* description : {"culled", "paper:sets=4", "light_bvh"}) {
        CAPTURE(description);
        const auto run = [&](std::uint64_t pass) {
            const auto sampler = make_sampler(description, lights);
            answers_of_pass(*sampler, 3000, 100 + pass);
            return answers_of_pass(*sampler, 3000, pass);
        };
        std::vector<Answers> answers(4);
        on_threads(4, [&](std::uint32_t i) { answers[i] = run(i / 2); });
        CHECK(answers[0] == run(0));
        CHECK(answers[1] == answers[0]);
        CHECK(answers[2] == run(1));
        CHECK(answers[3] == answers[2]);
    }
}

TEST_CASE("threads: two renders of one scene and two of another, all at once") {
    const std::shared_ptr<const Scene> scenes[] = {lamps_over_floor(20), lamps_over_floor(60)};
    std::vector<float3> images[4];
    on_threads(4, [&](std::uint32_t i) {
        images[i] = render(scenes[i / 2], i % 2 == 0 ? "culled" : "light_bvh");
    });
    for (std::uint32_t i = 0; i < 4; ++i) {
        CHECK(same_bits(images[i], render(scenes[i / 2], i % 2 == 0 ? "culled" : "light_bvh")));
    }
}

TEST_CASE("threads: scenes are built at once") {
    std::vector<float3> images[4];
    on_threads(4, [&](std::uint32_t i) { images[i] = render(lamps_over_floor(20), "culled"); });
    for (const auto& image : images) CHECK(same_bits(image, images[0]));
}

TEST_CASE(
    "threads: a host brings its own arena, of one thread or more, or is in a loop of its own") {
    const std::vector<Light> lights = mixed_lights(3000, 81, 5.0f);
    const auto scene = lamps_over_floor(20);
    const auto work = [&] {
        const auto sampler = make_sampler("culled", lights);
        return answers_of_pass(*sampler, 3000, 3);
    };
    const Answers expected = work();
    const std::vector<float3> image = render(scene, "culled");
    for (const int concurrency : {1, 2, 5}) {
        CAPTURE(concurrency);
        tbb::task_arena arena(concurrency);
        arena.execute([&] {
            CHECK(work() == expected);
            CHECK(same_bits(render(scene, "culled"), image));
        });
    }
    std::vector<Answers> answers(6);
    std::vector<float3> images[6];
    tbb::parallel_for(std::size_t{0}, std::size_t{6}, [&](std::size_t i) {
        answers[i] = work();
        images[i] = render(scene, "culled");
    });
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(answers[i] == expected);
        CHECK(same_bits(images[i], image));
    }
}

TEST_CASE("threads: a host allows one thread in all") {
    const auto scene = lamps_over_floor(20);
    const std::vector<float3> image = render(scene, "culled");
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(same_bits(render(scene, "culled"), image));
}
