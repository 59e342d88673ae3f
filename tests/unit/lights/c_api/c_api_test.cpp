#include <doctest/doctest.h>
#include <lightcull/lightcull.h>
#include <lightcull/samplers.h>
#include <lightcull/sets.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "base/random.h"
#include "unit/sanitizer.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

void copy(float3 from, float (&to)[3]) {
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

lightcull_light in_c(const Light& from) {
    lightcull_light light = LIGHTCULL_LIGHT_INIT;
    copy(from.center, light.center);
    light.radius = from.radius;
    copy(from.axis, light.axis);
    light.cos_theta_o = from.cos_theta_o;
    light.cos_theta_e = from.cos_theta_e;
    light.intensity = from.intensity;
    light.two_sided = from.two_sided ? 1 : 0;
    light.lobe_alpha = from.lobe_alpha;
    light.directional = from.directional ? 1 : 0;
    return light;
}

lightcull_shading_point in_c(const ShadingPoint& from) {
    lightcull_shading_point point = LIGHTCULL_SHADING_POINT_INIT;
    copy(from.position, point.position);
    copy(from.normal, point.normal);
    point.set = from.set;
    point.diffuse = from.diffuse;
    copy(from.lobe.axis, point.lobe.axis);
    point.lobe.alpha = from.lobe.alpha;
    point.lobe.peak = from.lobe.peak;
    return point;
}

template <typename From>
auto in_c(const std::vector<From>& from) {
    std::vector<decltype(in_c(from[0]))> all;
    all.reserve(from.size());
    for (const From& one : from) all.push_back(in_c(one));
    return all;
}

void require_equal(const lightcull_selection& c, const Selection& cpp) {
    REQUIRE(c.light == cpp.light);
    REQUIRE(c.prob == cpp.prob);
    REQUIRE(c.mis_prob == cpp.mis_prob);
    REQUIRE(c.receipt.weight_sum == cpp.receipt.weight_sum);
    REQUIRE(c.receipt.key == cpp.receipt.key);
}

/// A pass in C and in C++, to select from at the same points.
struct Both {
    const lightcull_pass* c;
    const LightSelector& cpp;

    void require_equal_selections(std::uint32_t light_count) const {
        REQUIRE(lightcull_set_count(c) == cpp.set_count());
        REQUIRE((lightcull_needs_receipt(c) == 1) == cpp.needs_receipt());
        const std::vector<ShadingPoint> points = mixed_points(600, 71, cpp.set_count());
        const std::vector<lightcull_shading_point> c_points = in_c(points);
        std::vector<float> u;
        for (std::size_t i = 0; i < points.size(); ++i) u.push_back(uniform_float(hash(i, 72)));
        std::vector<Selection> selections(points.size());
        std::vector<lightcull_selection> c_selections(points.size());
        cpp.select(points, u, selections);
        REQUIRE(lightcull_select_many(c, c_points.data(), u.data(), points.size(),
                                      c_selections.data()) == LIGHTCULL_OK);
        for (std::size_t i = 0; i < points.size(); ++i) {
            require_equal(c_selections[i], selections[i]);
            lightcull_selection one;
            lightcull_select(c, &c_points[i], u[i], &one);
            require_equal(one, cpp.select(points[i], u[i]));
            const auto other = static_cast<std::uint32_t>(i) % light_count;
            const float prob = cpp.prob(points[i], selections[i].receipt, other);
            REQUIRE(lightcull_prob(c, &c_points[i], &one.receipt, other) == prob);
            if (cpp.needs_receipt()) continue;
            REQUIRE(lightcull_prob(c, &c_points[i], nullptr, other) == prob);
        }
    }
};

void check_equal(const lightcull_light& c, const Light& cpp) {
    const lightcull_light expected = in_c(cpp);
    CHECK(c.size == sizeof c);
    CHECK(std::equal(c.center, c.center + 3, expected.center));
    CHECK(c.radius == expected.radius);
    CHECK(std::equal(c.axis, c.axis + 3, expected.axis));
    CHECK(c.cos_theta_o == expected.cos_theta_o);
    CHECK(c.cos_theta_e == expected.cos_theta_e);
    CHECK(c.intensity == expected.intensity);
    CHECK(c.two_sided == expected.two_sided);
    CHECK(c.lobe_alpha == expected.lobe_alpha);
    CHECK(c.directional == expected.directional);
}

}  // namespace

TEST_CASE("C and C++ select the same lights with the same probabilities, to the bit") {
    const std::vector<Light> lights = with_suns(mixed_lights(700, 70, 6.0f), 100);
    const std::vector<lightcull_light> c_lights = in_c(lights);
    const std::vector<ShadingPoint> calibration = mixed_points(50, 73, 1);
    const std::vector<lightcull_shading_point> c_calibration = in_c(calibration);
    const SamplerContext context{calibration, 640 * 480};
    lightcull_context c_context = LIGHTCULL_CONTEXT_INIT;
    c_context.points_per_pass = 640 * 480;
    c_context.calibration_points = c_calibration.data();
    c_context.calibration_point_count = c_calibration.size();
    const auto count = static_cast<std::uint32_t>(lights.size());
    for (const char* description :
         {"culled", "culled:sets=16:group=1", "light_bvh", "light_bvh:importance=means", "uniform",
          "power", "exhaustive", "clamped", "paper:test=light", "paper:test=light:list=0:sets=4"}) {
        CAPTURE(description);
        for (const bool has_context : {false, true}) {
            const auto cpp =
                make_sampler(description, lights, has_context ? context : SamplerContext{});
            lightcull_sampler* c = nullptr;
            REQUIRE(lightcull_sampler_create(description, c_lights.data(), c_lights.size(),
                                             has_context ? &c_context : nullptr,
                                             &c) == LIGHTCULL_OK);
            for (const std::uint64_t number : {std::uint64_t{3}, ~std::uint64_t{0}}) {
                cpp->begin_pass(number);
                REQUIRE(lightcull_sampler_begin_pass(c, number) == LIGHTCULL_OK);
                Both{lightcull_sampler_current_pass(c), *cpp}.require_equal_selections(count);
            }
            lightcull_pass* pass = nullptr;
            REQUIRE(lightcull_pass_create(c, 9, &pass) == LIGHTCULL_OK);
            lightcull_sampler_destroy(c);  // the pass outlives it
            Both{pass, *cpp->pass(9)}.require_equal_selections(count);
            lightcull_pass_destroy(pass);
        }
    }
}

TEST_CASE("lights made in C are those of C++") {
    const float3 p{1, -2, 3}, q{2, 0.5f, 4}, r{0, 1, 1}, d{0.6f, 0, -0.8f};
    float a[3], b[3], c[3], axis[3];
    copy(p, a);
    copy(q, b);
    copy(r, c);
    copy(d, axis);
    lightcull_light light = LIGHTCULL_LIGHT_INIT;
    check_equal(light, Light{});
    for (const bool two_sided : {false, true}) {
        CHECK(lightcull_triangle_light(a, b, c, 3.0f, two_sided, &light) == LIGHTCULL_OK);
        check_equal(light, triangle_light(p, q, r, 3.0f, two_sided));
        CHECK(lightcull_bounded_light(a, b, axis, 0.3f, 0.2f, two_sided, 4, &light) ==
              LIGHTCULL_OK);
        check_equal(light, bounded_light(p, q, d, 0.3f, 0.2f, two_sided, 4));
    }
    CHECK(lightcull_point_light(a, 2.0f, &light) == LIGHTCULL_OK);
    check_equal(light, point_light(p, 2.0f));
    CHECK(lightcull_spot_light(a, axis, 2.0f, 0.3f, 0.5f, &light) == LIGHTCULL_OK);
    check_equal(light, spot_light(p, d, 2.0f, 0.3f, 0.5f));
    CHECK(lightcull_diffuse_point_light(a, axis, 2.0f, &light) == LIGHTCULL_OK);
    check_equal(light, diffuse_point_light(p, d, 2.0f));
    CHECK(lightcull_glossy_point_light(a, axis, 2.0f, 0.25f, &light) == LIGHTCULL_OK);
    check_equal(light, glossy_point_light(p, d, 2.0f, 0.25f));
    CHECK(lightcull_directional_light(b, 2.0f, &light) == LIGHTCULL_OK);
    check_equal(light, directional_light(q, 2.0f));
    CHECK(lightcull_point_light(a, 2.0f, &light) == LIGHTCULL_OK);
    CHECK(light.directional == 0);
}

TEST_CASE("C: lights of hosts from before directional ones are taken") {
    constexpr std::uint32_t kFirstSize = offsetof(lightcull_light, directional);
    const std::vector<Light> lights = mixed_lights(20, 3);
    std::vector<std::uint8_t> bytes(lights.size() * kFirstSize);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lightcull_light light = in_c(lights[i]);
        light.size = kFirstSize;
        std::memcpy(bytes.data() + i * kFirstSize, &light, kFirstSize);
    }
    lightcull_sampler* sampler = nullptr;
    const auto* const first = reinterpret_cast<const lightcull_light*>(bytes.data());
    REQUIRE(lightcull_sampler_create("exhaustive", first, lights.size(), nullptr, &sampler) ==
            LIGHTCULL_OK);
    Both{lightcull_sampler_current_pass(sampler), *make_sampler("exhaustive", lights)}
        .require_equal_selections(20);
    lightcull_sampler_destroy(sampler);

    // They are set, but for what they have no room for.
    lightcull_light light = LIGHTCULL_LIGHT_INIT;
    light.size = kFirstSize;
    light.directional = 7;
    const float up[3] = {0, 1, 0};
    CHECK(lightcull_point_light(up, 2.0f, &light) == LIGHTCULL_OK);
    CHECK(light.directional == 7);
    CHECK(lightcull_directional_light(up, 2.0f, &light) == LIGHTCULL_INVALID_ARGUMENT);
    CHECK(std::string(lightcull_last_error()).find("without the field directional") !=
          std::string::npos);
    // All of an array are of one size.
    lightcull_light mixed[2] = {LIGHTCULL_LIGHT_INIT, LIGHTCULL_LIGHT_INIT};
    mixed[1].size = kFirstSize;
    CHECK(lightcull_sampler_create("uniform", mixed, 2, nullptr, &sampler) ==
          LIGHTCULL_INVALID_ARGUMENT);
    CHECK(std::string(lightcull_last_error()).find("light 1: size is") == 0);
}

TEST_CASE("sets in C are those of C++") {
    for (std::uint32_t i = 0; i < 200; ++i) {
        const std::uint32_t x = i % 16, y = i / 16;
        CHECK(lightcull_set_of_pixel(x, y, 7, 64) == set_of_pixel(x, y, 7, 64));
        CHECK(lightcull_set_of_packet(i, 256) == set_of_packet(i, 256));
        CHECK(lightcull_set_of_sample(x, y, i, 2, 1024) == set_of_sample(x, y, i, 2, 1024));
    }
}

TEST_CASE("each thread keeps the text of its own last error in C") {
    REQUIRE(lightcull_use_instruction_set("here") == LIGHTCULL_INVALID_ARGUMENT);
    std::string before, after;
    std::thread([&] {
        before = lightcull_last_error();
        lightcull_use_instruction_set("there");
        after = lightcull_last_error();
    }).join();
    CHECK(before.empty());
    CHECK(after.find("'there'") != std::string::npos);
    CHECK(std::string(lightcull_last_error()).find("'here'") != std::string::npos);
}

namespace {

/// While it lives, the process gets next to no more memory from the system.
class NoMoreMemory {
  public:
    NoMoreMemory() {
        getrlimit(RLIMIT_AS, &before_);
        std::size_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        constexpr rlim_t kPage = 4096;
        const rlimit none{pages * kPage, before_.rlim_max};
        setrlimit(RLIMIT_AS, &none);
    }
    ~NoMoreMemory() { setrlimit(RLIMIT_AS, &before_); }
    NoMoreMemory(const NoMoreMemory&) = delete;
    NoMoreMemory& operator=(const NoMoreMemory&) = delete;

  private:
    rlimit before_{};
};

}  // namespace

TEST_CASE("where memory lacks, C gets an error and selections are left as they were") {
    // Sanitizers end the process that asks for too much.
    if (kAddressSanitizer || kThreadSanitizer) return;
    const std::vector<lightcull_light> lights = in_c(mixed_lights(50, 74));
    lightcull_sampler* sampler = nullptr;
    REQUIRE(lightcull_sampler_create("culled", lights.data(), lights.size(), nullptr, &sampler) ==
            LIGHTCULL_OK);
    REQUIRE(lightcull_sampler_begin_pass(sampler, 0) == LIGHTCULL_OK);
    const lightcull_pass* pass = lightcull_sampler_current_pass(sampler);
    // The points are enough to want 80 MB, which is more than the heap keeps of what was freed.
    constexpr std::size_t kPoints = 4 << 20;
    constexpr lightcull_shading_point kPoint = LIGHTCULL_SHADING_POINT_INIT;
    const std::vector<lightcull_shading_point> points(kPoints, kPoint);
    const std::vector<float> u(kPoints, 0.5f);
    std::vector<lightcull_selection> selections(kPoints);
    lightcull_error error = LIGHTCULL_OK;
    {
        const NoMoreMemory no_more;
        error = lightcull_select_many(pass, points.data(), u.data(), kPoints, selections.data());
    }
    CHECK(error == LIGHTCULL_OUT_OF_MEMORY);
    CHECK(std::string(lightcull_last_error()).find("memory") != std::string::npos);
    bool are_left = true;
    for (const lightcull_selection& s : selections) are_left = are_left && s.prob == 0.0f;
    CHECK(are_left);
    CHECK(lightcull_select_many(pass, points.data(), u.data(), 300, selections.data()) ==
          LIGHTCULL_OK);
    CHECK(selections[0].prob > 0.0f);
    lightcull_sampler_destroy(sampler);
}

TEST_CASE("C: lights that move are chosen as in C++, and what was done is told") {
    lightcull_light c_lights[3] = {LIGHTCULL_LIGHT_INIT, LIGHTCULL_LIGHT_INIT,
                                   LIGHTCULL_LIGHT_INIT};
    const float center[3] = {0, 2, 0}, normal[3] = {0, -1, 0}, end[3] = {1, 2, 3};
    REQUIRE(lightcull_sphere_light(center, 0.5f, 2.0f, &c_lights[0]) == LIGHTCULL_OK);
    REQUIRE(lightcull_disc_light(center, normal, 0.5f, 2.0f, 1, &c_lights[1]) == LIGHTCULL_OK);
    REQUIRE(lightcull_cylinder_light(center, end, 0.1f, 2.0f, &c_lights[2]) == LIGHTCULL_OK);
    std::vector<Light> lights{sphere_light({0, 2, 0}, 0.5f, 2.0f),
                              disc_light({0, 2, 0}, {0, -1, 0}, 0.5f, 2.0f, true),
                              cylinder_light({0, 2, 0}, {1, 2, 3}, 0.1f, 2.0f)};
    const auto sampler = make_sampler("culled:sets=4", lights);
    lightcull_sampler* c_sampler = nullptr;
    REQUIRE(lightcull_sampler_create("culled:sets=4", c_lights, 3, nullptr, &c_sampler) ==
            LIGHTCULL_OK);
    c_lights[0].center[0] = 3.0f;
    lights[0].center.x = 3.0f;
    const LightUpdate done = sampler->update(lights);
    lightcull_update update = LIGHTCULL_UPDATE_INIT;
    REQUIRE(lightcull_sampler_update(c_sampler, c_lights, 3, 2.0f, &update) == LIGHTCULL_OK);
    CHECK((update.rebuilt != 0) == done.rebuilt);
    CHECK(update.growth == done.growth);
    sampler->begin_pass(4);
    REQUIRE(lightcull_sampler_begin_pass(c_sampler, 4) == LIGHTCULL_OK);
    for (int i = 0; i < 50; ++i) {
        const float x = 0.1f * static_cast<float>(i), u = 0.02f * static_cast<float>(i);
        lightcull_shading_point point = LIGHTCULL_SHADING_POINT_INIT;
        point.position[0] = x;
        lightcull_selection c_selection;
        lightcull_select(lightcull_sampler_current_pass(c_sampler), &point, u, &c_selection);
        const Selection selection = sampler->select({{x, 0, 0}, {0, 0, 0}, 0}, u);
        CHECK(c_selection.light == selection.light);
        CHECK(c_selection.prob == selection.prob);
    }
    CHECK(lightcull_sampler_update(c_sampler, c_lights, 2, 2.0f, nullptr) ==
          LIGHTCULL_INVALID_ARGUMENT);
    CHECK(std::string(lightcull_last_error()) ==
          "update: there are 2 lights, and the sampler was made over 3");
    update.size = 1;
    CHECK(lightcull_sampler_update(c_sampler, c_lights, 3, 2.0f, &update) ==
          LIGHTCULL_INVALID_ARGUMENT);
    lightcull_sampler_destroy(c_sampler);
}
