#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/instruction_set.h>
#include <lightcull/render/renderer.h>
#include <lightcull/render/shadow_rays.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "unit/render/render_support.h"
#include "unit/test_lights.h"

/// These tests show what the functions of the library that set something up say of arguments that
/// make no sense. Tests of scenes are in render_scene_test.cpp, tests of images in image_test.cpp.

using namespace render_support;
using namespace lightcull::testing;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The text of the Error that the function throws: a line, or "" if it throws none.
std::string error_of(const std::function<void()>& function) {
    try {
        function();
    } catch (const Error& error) {
        std::string message = error.what();
        CHECK(message.find('\n') == std::string::npos);
        return message;
    }
    return {};
}

bool says(const std::string& message, const std::string& part) {
    CAPTURE(message);
    CAPTURE(part);
    return message.find(part) != std::string::npos;
}

using MakeSampler = std::function<std::unique_ptr<LightSampler>(Span<const Light>)>;

/// Every function that makes a sampler, by each of its names.
std::vector<MakeSampler> all_makers() {
    std::vector<MakeSampler> makers{
        [](auto lights) { return make_sampler(UniformOptions{}, lights); },
        [](auto lights) { return make_sampler(PowerOptions{}, lights); },
        [](auto lights) { return make_sampler(ExhaustiveOptions{}, lights); },
        [](auto lights) { return make_sampler(LightBvhOptions{}, lights); },
        [](auto lights) {
            return make_sampler(LightBvhOptions{ClusterImportance::kMeans}, lights);
        },
        [](auto lights) { return make_sampler(CulledOptions{}, lights); },
        [](auto lights) { return make_sampler(PaperOptions{}, lights); },
        [](auto lights) { return make_sampler(ClampedOptions{}, lights); },
    };
    for (const char* name : {"uniform", "power", "exhaustive", "light_bvh", "culled", "paper",
                             "clamped", "light_bvh:importance=means", "culled:group=1"}) {
        makers.push_back([name](auto lights) { return make_sampler(name, lights); });
    }
    return makers;
}

/// The errors of ranges like that, from each sampler that has them.
std::vector<std::string> errors_of_range(const RangeOptions& range,
                                         const SamplerContext& context = {}) {
    const std::vector<Light> lights = mixed_lights(5, 1);
    CulledOptions culled;
    PaperOptions paper;
    ClampedOptions clamped;
    culled.range = paper.range = clamped.range = range;
    return {error_of([&] { make_sampler(culled, lights, context); }),
            error_of([&] { make_sampler(paper, lights, context); }),
            error_of([&] { make_sampler(clamped, lights, context); })};
}

}  // namespace

TEST_CASE("bad input: every sampler names the light and the field") {
    struct Case {
        const char* message;
        std::function<void(Light&)> spoil;
    };
    const Case cases[] = {
        {"light 3: center is not finite", [](Light& l) { l.center.x = kNan; }},
        {"light 3: center is not finite", [](Light& l) { l.center.z = -kInfinity; }},
        {"light 3: radius is nan", [](Light& l) { l.radius = kNan; }},
        {"light 3: radius is -", [](Light& l) { l.radius = -1e-30f; }},
        {"light 3: intensity is -1", [](Light& l) { l.intensity = -1.0f; }},
        {"light 3: intensity is nan", [](Light& l) { l.intensity = kNan; }},
        {"light 3: intensity is inf", [](Light& l) { l.intensity = kInfinity; }},
        {"light 3: cos_theta_o is nan", [](Light& l) { l.cos_theta_o = kNan; }},
        {"light 3: cos_theta_e is 2", [](Light& l) { l.cos_theta_e = 2.0f; }},
        {"light 3: axis has length nan", [](Light& l) { l.axis.y = kNan; }},
        {"light 3: axis has length 0",
         [](Light& l) {
             l.axis = {0, 0, 0};
         }},
    };
    for (const Case& c : cases) {
        std::vector<Light> lights = mixed_lights(6, 1);
        REQUIRE(lights[3].cos_theta_o == 1.0f);  // a triangle: it has an axis
        c.spoil(lights[3]);
        for (const MakeSampler& make : all_makers()) {
            CHECK(says(error_of([&] { make(lights); }), c.message));
        }
    }
}

TEST_CASE("bad input: lights made of nonsense are refused by samplers, and do not crash") {
    const Light lights[] = {
        triangle_light({kNan, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1.0f),
        triangle_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, -1.0f),
        triangle_light({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, kInfinity),
        point_light({0, kInfinity, 0}, 1.0f),
        point_light({0, 0, 0}, kNan),
        spot_light({0, 0, 0}, {0, 0, 0}, 1.0f, 0.1f, 0.2f),
        spot_light({0, 0, 0}, {0, 0, 1}, 1.0f, kNan, 0.2f),
        spot_light({0, 0, 0}, {0, 0, 1}, 1.0f, 0.1f, kInfinity),
        bounded_light({0, 0, kNan}, {1, 1, 1}, {0, 0, 1}, 1, 0, false, 1.0f),
        bounded_light({0, 0, 0}, {1, 1, 1}, {0, 0, 0}, 1, 0, false, 1.0f),
        bounded_light({0, 0, 0}, {1, 1, 1}, {0, 0, 1}, 1, 0, false, -1.0f),
        bounded_light({0, 0, 0}, {1, 1, 1}, {0, 0, 1}, 7, 0, false, 1.0f),
        bounded_light({0, 0, 0}, {1, 1, 1}, {0, 0, 1}, 1, kNan, false, 1.0f),
    };
    for (const Light& light : lights) {
        CAPTURE(&light - lights);
        CHECK(says(error_of([&] { make_sampler(CulledOptions{}, {&light, 1}); }), "light 0: "));
    }
}

TEST_CASE("bad input: ranges that make no sense are named") {
    for (const float value : {kNan, kInfinity, 0.0f, -1.0f}) {
        RangeOptions range;
        range.error_bound = value;
        for (const auto& e : errors_of_range(range)) CHECK(says(e, "error_bound is "));
        range = {};
        range.expected_accepted = value;
        for (const auto& e : errors_of_range(range)) CHECK(says(e, "expected_accepted is "));
        range = {};
        range.exposure = value;
        for (const auto& e : errors_of_range(range)) CHECK(says(e, "exposure is "));
    }
    const std::function<void(ShadingPoint&)> spoils[] = {
        [](ShadingPoint& p) { p.position.x = kNan; },
        [](ShadingPoint& p) { p.normal.z = kInfinity; },
        [](ShadingPoint& p) { p.diffuse = kNan; },
        [](ShadingPoint& p) { p.lobe.axis.y = kNan; },
        [](ShadingPoint& p) { p.lobe.alpha = kInfinity; },
        [](ShadingPoint& p) { p.lobe.peak = kNan; },
    };
    for (const auto& spoil : spoils) {
        std::vector<ShadingPoint> points = mixed_points(4, 2, 1);
        spoil(points[2]);
        SamplerContext context;
        context.calibration_points = points;
        for (const auto& e : errors_of_range({}, context)) {
            CHECK(says(e, "calibration point 2 is not finite"));
        }
    }
}

TEST_CASE("bad input: options of samplers that make no sense are named") {
    const std::vector<Light> lights = mixed_lights(5, 1);
    for (const std::uint32_t sets : {0u, 3u, 12u, 16384u, 1u << 31, 0xffffffffu}) {
        CulledOptions culled;
        PaperOptions paper;
        culled.set_count = paper.set_count = sets;
        const std::string wanted = "sets is " + std::to_string(sets) + ", wanted a power of 4";
        CHECK(says(error_of([&] { make_sampler(culled, lights); }), wanted));
        CHECK(says(error_of([&] { make_sampler(paper, lights); }), wanted));
    }
    CulledOptions culled;
    culled.group_size = 0;
    CHECK(says(error_of([&] { make_sampler(culled, lights); }), "group is 0, wanted 1"));
    PaperOptions paper;
    paper.list_size = 65;
    CHECK(says(error_of([&] { make_sampler(paper, lights); }), "list is 65, wanted 0 to 64"));
    culled = {};
    culled.group_size = 0xffffffffu;  // as many as there are
    CHECK(make_sampler(culled, lights) != nullptr);
}

TEST_CASE("bad input: descriptions that make no sense are named") {
    const std::vector<Light> lights = mixed_lights(5, 1);
    for (const char* description : {"",
                                    ":",
                                    "culled:",
                                    "culled:=",
                                    "culled:sets=",
                                    "culled:sets=4.5",
                                    "culled:sets=-4",
                                    "culled:sets=99999999999999",
                                    "culled:group=0",
                                    "culled:accepted=nan",
                                    "culled:accepted=inf",
                                    "culled:error_bound=",
                                    "paper:list=-1",
                                    "clamped:sets=4",
                                    "power:sets=1",
                                    " culled",
                                    "culled ",
                                    "Culled",
                                    "culled:sets=4:",
                                    "culled:sets=4 "}) {
        CAPTURE(description);
        CHECK_FALSE(error_of([&] { make_sampler(description, lights); }).empty());
    }
    for (const char* name :
         {"uniform", "power", "exhaustive", "light_bvh", "culled", "paper", "clamped"}) {
        const std::string description = std::string(name) + ":unheard=1";
        CHECK(says(error_of([&] { make_sampler(description, lights); }),
                   "no option 'unheard' for " + std::string(name)));
    }
    for (const char* number : {"99999999999999", "-1", "1.5", "0x10", ""}) {
        const std::string description = std::string("culled:group=") + number;
        CHECK(says(error_of([&] { make_sampler(description, lights); }),
                   std::string("group is '") + number + "', wanted a number"));
    }
}

TEST_CASE("bad input: more lights than there may be") {
    // Nobody looks at any of them before they are counted.
    const Light light = point_light({0, 0, 0}, 1.0f);
    const Span<const Light> lights(&light, std::size_t{1} << 31);
    for (const MakeSampler& make : all_makers()) {
        CHECK(error_of([&] { make(lights); }) == "too many lights: 2147483648, at most 1073741824");
    }
}

TEST_CASE("bad input: settings of renders that make no sense are named") {
    auto scene = std::make_shared<Scene>();
    scene->commit();
    const auto error = [&](const std::function<void(RenderSettings&)>& spoil) {
        RenderSettings settings;
        spoil(settings);
        const auto sampler = make_sampler(UniformOptions{}, {});
        std::string message =
            error_of([&] { Renderer(scene, settings, make_sampler(UniformOptions{}, {})); });
        CHECK(error_of([&] { camera_points(*scene, settings, 1); }) == message);
        CHECK(error_of([&] { pixel_points(*scene, settings); }) == message);
        CHECK(error_of([&] { path_points(*scene, settings, *sampler, 1); }) == message);
        CHECK(error_of([&] { make_scene_sampler("culled", *scene, settings); }) == message);
        return message;
    };
    for (const std::uint32_t edge : {0u, 65536u, 1u << 31, 0xffffffffu}) {
        CHECK(error([&](auto& s) { s.width = edge; }) == "settings: width is not in [1, 65535]");
        CHECK(error([&](auto& s) { s.height = edge; }) == "settings: height is not in [1, 65535]");
    }
    CHECK(says(error([](auto& s) { s.max_depth = 0; }), "settings: max_depth is 0"));
    CHECK(error([](auto& s) { s.threads = 65536; }) == "settings: threads is above 65535");
    for (const int unknown : {-1, 3}) {
        CHECK(error([&](auto& s) { s.direct_light = static_cast<DirectLight>(unknown); }) ==
              "settings: direct_light is unknown");
    }
    const auto sampler = make_sampler(UniformOptions{}, {});
    for (const std::uint32_t depth : {0u, 65536u}) {
        CHECK(error_of([&] { path_points(*scene, {}, *sampler, depth); }) ==
              "path_points: depth is not in [1, 65535]");
    }
    CHECK(error_of([&] { path_points(Scene(), {}, *sampler, 1); }) ==
          "scene: commit() must come before rendering");
    CHECK(camera_points(*scene, {}, 0).empty());
}

TEST_CASE("bad input: shadow rays of other points or lights are refused") {
    Scene scene;
    const ShadingPoint points[2] = {};
    const Selection good[] = {{0, 0.0f, 0.0f, {}}, {9, 0.0f, 0.0f, {}}},
                    bad[] = {{}, {1, 0.5f, 0.5f, {}}};
    CHECK(error_of([&] { ShadowRays(scene, points, good); }) ==
          "scene: commit() must come before rendering");
    scene.add_point_light({0, 1, 0}, {1, 1, 1});
    scene.commit();
    CHECK(error_of([&] {
              ShadowRays(scene, points, {good, 1});
          }) == "shadow rays: there are 1 selections for 2 points");
    CHECK(error_of([&] { ShadowRays(scene, points, bad); }) ==
          "shadow rays: selections[1]: light is 1, but there are 1 lights");
    CHECK(ShadowRays(scene, points, good).size() == 0);
}

TEST_CASE("bad input: an instruction set that is not there is named, and the one in use stays") {
    const std::string before = instruction_set();
    for (const char* name : {"", "sse1", "AVX1024"}) {
        CHECK(says(error_of([&] { use_instruction_set(name); }), before));
    }
    CHECK(instruction_set() == before);
}
