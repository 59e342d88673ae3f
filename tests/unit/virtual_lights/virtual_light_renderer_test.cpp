#include "base/random.h"
#include "lights/ranges/ranges.h"
#include "unit/render/render_support.h"
#include "unit/sanitizer.h"
#include "virtual_lights/paths/light_paths.h"
#include "virtual_lights/tiles/tiled_lighting.h"

#include <lightcull/error.h>
#include <lightcull/virtual_lights/virtual_light_renderer.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

using namespace render_support;
using statistics::Accumulator;
using statistics::Estimate;

namespace {

/// Two walls and a floor, a lamp that faces the floor, and things of two materials on it.
std::shared_ptr<Scene> corner(float glossy_roughness, float field_of_view = 0.7f) {
    Shape room;
    room.add_level_square({0, 0, 0}, 2.0f, true);
    room.add_quad({-2, 0, 2}, {-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2});
    room.add_quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2});
    auto scene = ball_under_lamp(room, gloss(glossy_roughness), field_of_view);
    scene->commit();
    return scene;
}

/// The sums of tiled lighting for the same camera points and virtual lights in every pass.
class Passes {
  public:
    Passes(const Scene& scene, const std::string& method, std::uint32_t edge = 48)
        : options_(parse_virtual_light_method(method)),
          settings_(square_image(edge, 3)),
          camera_(scene.camera(), edge, edge),
          view_(trace_camera_view(data_of(scene), settings_, PassRays(camera_, settings_, 1))),
          lights_(virtual_lights(
              data_of(scene), emit(EmissionTable(data_of(scene)), options_.light_paths, 1), 2, 1)),
          cloud_(data_of(scene), 16, options_.map_points, 1),
          tracer_(*data_of(scene).ray_tracer) {
        for (const auto h : view_.hit) seen_ += h;
    }

    /// reach: the reach of random ranges; that of constant ones is such that the error bound is the
    /// same.
    std::vector<V3f> pass(std::uint64_t number, float reach = 1.0f) {
        const bool constant = options_.method == VirtualLightMethod::kClamped;
        const auto count = static_cast<float>(lights_.size());
        RandomRanges ranges(constant ? 2.0f * count * reach : reach, 1,
                            constant ? RangeLaw::kConstant : RangeLaw::kRandom);
        ranges.begin_pass(number);
        std::vector<V3f> pixels(view_.hit.size(), V3f(0.0f));
        counts = add_tiled_lighting(
            {tracer_, camera_, view_, options_, hash(number, 5), nullptr, &cloud_}, lights_,
            Acceptance(options_.method, ranges), pixels);
        return pixels;
    }

    /// The estimates of the blocks of an image, over passes.
    std::vector<Estimate> blocks(std::uint32_t passes, float reach) {
        constexpr std::uint32_t kBlock = 12;
        const std::uint32_t columns = view_.width / kBlock;
        std::vector<Accumulator> accumulators(std::size_t{columns} * columns);
        for (std::uint32_t p = 0; p < passes; ++p) {
            std::vector<double> sums(accumulators.size(), 0.0);
            const std::vector<V3f> pixels = pass(p, reach);
            for (std::uint32_t i = 0; i < pixels.size(); ++i) {
                sums[i / view_.width / kBlock * columns + i % view_.width / kBlock] +=
                    static_cast<double>(lightcull::luminance(pixels[i]));
            }
            for (std::size_t b = 0; b < sums.size(); ++b) accumulators[b].add(sums[b]);
        }
        std::vector<Estimate> estimates;
        estimates.reserve(accumulators.size());
        for (const auto& a : accumulators) estimates.push_back(a.estimate());
        return estimates;
    }

    const std::vector<VirtualLight>& lights() const { return lights_; }
    const CameraView& view() const { return view_; }
    std::size_t seen() const { return seen_; }

    LightingCounts counts;

  private:
    VirtualLightOptions options_;
    RenderSettings settings_;
    CameraRays camera_;
    CameraView view_;
    std::vector<VirtualLight> lights_;
    PointCloud cloud_;
    const RayTracer& tracer_;
    std::size_t seen_ = 0;
};

std::unique_ptr<VirtualLightRenderer> renderer(const std::shared_ptr<const Scene>& scene,
                                               const std::string& method,
                                               const RenderSettings& settings) {
    return std::make_unique<VirtualLightRenderer>(scene, settings,
                                                  parse_virtual_light_method(method),
                                                  make_scene_sampler("power", *scene, settings));
}

bool same(const std::vector<float3>& a, const std::vector<float3>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](float3 x, float3 y) { return x.x == y.x && x.y == y.y && x.z == y.z; });
}

}  // namespace

TEST_CASE("vpl_culled equals vpl_all in the mean, vpl_clamped does not") {
    const auto scene = corner(0.5f);
    constexpr std::uint32_t kPasses = lightcull::testing::repetitions(200, 50);
    for (const std::string shadows : {":shadows=none", ":shadows=rays"}) {
        const std::string lights = ":lights=1000:filter=off" + shadows;
        const std::vector<Estimate> all = Passes(*scene, "vpl_all" + lights).blocks(2, 1.0f);
        for (const std::string interleave : {":interleave=1", ":interleave=4", ":interleave=8"}) {
            CAPTURE(interleave);
            std::string method = "vpl_culled" + lights;
            method += interleave;
            Passes culled(*scene, method);
            const auto means = culled.blocks(kPasses, 60.0f);
            CHECK(culled.counts.accepted * 10 < culled.seen() * culled.lights().size());
            CHECK(statistics::worst_p(means, all) > statistics::least_p());
        }
        // The clamped method has more lights than vpl_culled accepts, and is still too dark.
        Passes culled(*scene, "vpl_culled:interleave=8" + lights);
        Passes clamped(*scene, "vpl_clamped:interleave=8" + lights);
        culled.pass(0, 60.0f);
        const auto means = clamped.blocks(kPasses, 0.5f);
        CHECK(clamped.counts.accepted > culled.counts.accepted);
        CHECK(statistics::worst_p(means, all) < statistics::least_p());
    }
}

TEST_CASE("the volumes that cull change the cost, not the image") {
    const auto scene = corner(0.2f);
    std::vector<std::vector<V3f>> images;
    std::vector<std::uint64_t> listed;
    for (const char* volume : {"spheroid", "sphere_around", "sphere_at_light"}) {
        Passes passes(
            *scene,
            std::string("vpl_culled:lights=2000:interleave=1:shadows=none:volume=") + volume);
        images.push_back(passes.pass(3, 10.0f));
        listed.push_back(passes.counts.listed);
        CHECK(passes.counts.accepted > passes.seen());
    }
    CHECK(images[0] == images[1]);
    CHECK(images[0] == images[2]);
    CHECK(listed[0] < listed[1]);
    CHECK(listed[1] < listed[2]);
}

TEST_CASE("where lights are looked for changes the cost, not the image") {
    const auto scene = corner(0.2f);
    const std::string method = ":lights=3000:interleave=2:shadows=none:filter=off:";
    for (const std::string name : {"vpl_culled", "vpl_clamped"}) {
        std::vector<std::vector<V3f>> images;
        std::vector<std::uint64_t> listed, accepted;
        for (const char* culling : {"tile=1", "tile=5", "tile=16", "culling=splatting"}) {
            Passes passes(*scene, name + method + culling);
            images.push_back(passes.pass(3, name == "vpl_culled" ? 60.0f : 0.01f));
            listed.push_back(passes.counts.listed);
            accepted.push_back(passes.counts.accepted);
            CHECK(images.back() == images[0]);
            CHECK(accepted.back() == accepted[0]);
            CHECK(accepted.back() < listed.back());
            CHECK(2 * passes.seen() < accepted.back());
            CHECK(listed.back() < passes.seen() * passes.lights().size() / 8);
        }
        CHECK(listed[0] < listed[1]);
        CHECK(listed[1] < listed[2]);
    }
}

TEST_CASE("splatting finds what tiles find where whole columns and rows show nothing") {
    const auto scene = corner(0.2f, 2.0f);
    std::vector<std::vector<V3f>> images;
    std::vector<std::uint64_t> accepted;
    for (const char* culling : {"tile=5", "culling=splatting"}) {
        Passes passes(*scene, std::string("vpl_culled:lights=3000:interleave=2:shadows=none:") +
                                  "filter=off:" + culling);
        const auto& hit = passes.view().hit;
        CHECK(std::none_of(hit.begin(), hit.begin() + 48, [](auto h) { return h != 0; }));
        images.push_back(passes.pass(3, 60.0f));
        accepted.push_back(passes.counts.accepted);
    }
    CHECK(images[0] == images[1]);
    CHECK(accepted[0] == accepted[1]);
    CHECK(accepted[0] > 100);
}

TEST_CASE("the lights of pixels are those of the passes") {
    const auto scene = corner(0.2f);
    RenderSettings settings = square_image(24, 3);
    for (const char* culling : {"tile=4", "culling=splatting"}) {
        const auto r = renderer(
            scene, std::string("vpl_culled:lights=1000:shadows=none:") + culling, settings);
        r->render_pass();
        std::atomic<bool> cancel{true};
        CHECK(!r->render_pass(&cancel));
        r->render_pass();
        std::uint64_t listed = 0, accepted = 0;
        for (const LightsOfPixel& of_pixel : r->lights_of_pixels()) {
            CHECK(of_pixel.accepted <= of_pixel.listed);
            listed += of_pixel.listed;
            accepted += of_pixel.accepted;
        }
        CHECK(listed == r->virtual_light_stats().listed);
        CHECK(accepted == r->virtual_light_stats().accepted);
        CHECK(accepted > 0);
    }
}

TEST_CASE("imperfect shadow maps shade about what rays do, culled or not") {
    const auto scene = corner(0.5f);
    const auto mean = [&](const std::string& shadows) {
        Passes passes(*scene, "vpl_all:lights=1000:shadows=" + shadows);
        double sum = 0.0;
        for (const V3f& p : passes.pass(0)) sum += static_cast<double>(lightcull::luminance(p));
        return sum;
    };
    const double rays = mean("rays"), none = mean("none");
    CHECK(none > 1.03 * rays);
    for (const char* culling : {"on", "off"}) {
        const double maps = mean(std::string("maps:map_culling=") + culling);
        CAPTURE(culling);
        CAPTURE(maps / rays);
        CAPTURE(none / rays);
        CHECK(std::fabs(maps - rays) < 0.4 * (none - rays));
    }
}

TEST_CASE(
    "imperfect shadow maps: what is out of a light's range is left out, and changes nothing") {
    const auto scene = corner(0.5f);
    std::vector<std::vector<V3f>> images;
    std::vector<std::uint64_t> points;
    for (const char* culling : {"on", "off"}) {
        Passes passes(*scene, std::string("vpl_culled:lights=1000:interleave=1:filter=off:") +
                                  "shadows=maps:map_culling=" + culling);
        images.push_back(passes.pass(3, 10.0f));
        points.push_back(passes.counts.map_points);
    }
    CHECK(images[0] == images[1]);
    CHECK(points[0] > 0);
    CHECK(points[0] < points[1] / 2);
}

TEST_CASE("random numbers shared by all pixels leave a pixel the variance of its own ones") {
    const auto scene = corner(0.5f);
    constexpr float kReach = 30.0f;
    constexpr std::uint32_t kPasses = 3000;
    Passes passes(*scene, "vpl_culled:lights=300:interleave=1:shadows=none", 16);
    Passes every(*scene, "vpl_all:lights=300:interleave=1:shadows=none", 16);
    const std::vector<V3f> all = every.pass(0);

    // The variance of roulette with a number per pixel and light, in closed form.
    std::vector<double> exact(all.size(), 0.0);
    std::size_t given = 0, too_near = 0;
    const float nearest2 = nearest_distance2(passes.lights());
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (passes.view().hit[i] == 0) continue;
        const Surface& surface = passes.view().surfaces[i];
        double sum = 0.0;
        for (const VirtualLight& light : passes.lights()) {
            const V3f way = light.position - surface.position;
            const float distance2 = way.dot(way);
            const V3f direction = lightcull::unit(way);
            const V3f sent = intensity(light, -direction);
            if (surface.normal.dot(direction) <= 0.0f || !(sent.x > 0.0f)) continue;
            const double value = static_cast<double>(lightcull::luminance(
                sent * surface.bsdf.evaluate(direction).value / std::fmax(distance2, nearest2)));
            const double p = std::fmin(
                1.0, static_cast<double>(kReach * lightcull::luminance(sent) / distance2));
            exact[i] += value * value * (1.0 / p - 1.0);
            sum += value;
            ++given;
            too_near += distance2 < nearest2 ? 1 : 0;
        }
        CHECK(static_cast<double>(lightcull::luminance(all[i])) ==
              doctest::Approx(sum).epsilon(1e-4).scale(0.0));
    }
    CHECK(too_near > 10);
    // The shadow rays are as many as there are lights that give a pixel anything, but for rounding.
    Passes shadowed(*scene, "vpl_all:lights=300:interleave=1:shadows=rays", 16);
    shadowed.pass(0);
    CHECK(static_cast<double>(shadowed.counts.shadow_rays) ==
          doctest::Approx(static_cast<double>(given)).scale(0.0).epsilon(1e-3));

    std::vector<double> squares(all.size(), 0.0);
    for (std::uint32_t p = 0; p < kPasses; ++p) {
        const std::vector<V3f> pixels = passes.pass(p, kReach);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double off = static_cast<double>(lightcull::luminance(pixels[i] - all[i]));
            squares[i] += off * off / kPasses;
        }
    }
    double ratio = 0.0, pixels = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!(exact[i] > 0.0)) continue;
        ratio += squares[i] / exact[i];
        pixels += 1.0;
    }
    CHECK(pixels > 100.0);
    CHECK(ratio / pixels == doctest::Approx(1.0).scale(0.0).epsilon(0.03));
}

TEST_CASE("virtual lights agree with the path tracer") {
    // Light bounces between large diffuse surfaces, where nothing is near a virtual light for long.
    const auto scene = corner(1.0f);
    RenderSettings settings = square_image(32, 4);
    const Estimate traced = render_mean(scene, settings, "power", 600);
    const auto vpl =
        renderer(scene, "vpl_culled:lights=4096:accepted=64:interleave=4:filter=off", settings);
    Accumulator passes;
    double before = 0.0;
    for (int p = 1; p <= 60; ++p) {
        vpl->render_pass();
        double sum = 0.0;
        for (const float3 c : vpl->image()) sum += render_support::luminance(c) * p;
        passes.add((sum - before) / 1024.0);
        before = sum;
    }
    CAPTURE(traced.mean);
    CAPTURE(passes.estimate().mean);
    // Light within the least distance of a virtual light is missing: a per cent or two.
    CHECK(passes.estimate().mean == doctest::Approx(traced.mean).epsilon(0.02).scale(0.0));
}

TEST_CASE("virtual lights: the same bits for any number of threads, and none after a cancel") {
    const auto scene = corner(0.5f);
    RenderSettings settings = square_image(40, 3);
    std::vector<std::vector<float3>> images;
    for (const std::uint32_t threads : {1u, 2u}) {
        settings.threads = threads;
        const auto r = renderer(scene, "vpl_culled:lights=2000", settings);
        CHECK(r->render_pass());
        CHECK(r->render_pass());
        images.push_back(r->image());
        std::atomic<bool> cancel{true};
        CHECK(!r->render_pass(&cancel));
        CHECK(same(r->image(), images.back()));
        CHECK(r->stats().passes == 2);
    }
    CHECK(same(images[0], images[1]));
}

TEST_CASE("virtual lights: bad input is refused, nothing to do is done") {
    const auto scene = corner(0.5f);
    CHECK_THROWS_AS(renderer(scene, "vpl_culled", square_image(8, 2)), Error);
    CHECK_THROWS_AS(renderer(scene, "vpl_culled", square_image(8, 6)), Error);
    CHECK_THROWS_WITH_AS(renderer(corner(0.0f), "vpl_culled", square_image(8, 3)),
                         "virtual lights: material 1 has roughness 0: a perfect mirror sends light "
                         "to single points, which virtual lights cannot",
                         Error);
    for (const char* method : {"vpl",
                               "vpl_all:accepted=3",
                               "vpl_culled:lights=0",
                               "vpl_culled:interleave=3",
                               "vpl_culled:shadows=soft",
                               "vpl_clamped:volume=spheroid",
                               "vpl_culled:lights=x",
                               "vpl_culled:source=shadow_map:lights=1000",
                               "vpl_culled:error_bound=no",
                               "vpl_grid:shadows=maps",
                               "vpl_culled:points=10",
                               "vpl_all:shadows=maps:points=0",
                               "vpl_culled:lights=67108865",
                               "vpl_culled:shadows=maps:points=1048577",
                               "vpl_grid:samples=0",
                               "vpl_grid:samples=1025",
                               "vpl_grid:alpha=0",
                               "vpl_grid:alpha=inf",
                               "vpl_culled:error_bound=-1",
                               "vpl_clamped:exposure=inf",
                               "vpl_culled:accepted=nan",
                               "vpl_culled:tile=0",
                               "vpl_culled:tile=65",
                               "vpl_all:tile=4",
                               "vpl_culled:culling=none",
                               "vpl_culled:culling=splatting",
                               "vpl_culled:shadows=none:culling=splatting:tile=8"}) {
        CAPTURE(method);
        CHECK_THROWS_AS(parse_virtual_light_method(method), Error);
    }
    CHECK_THROWS_WITH_AS(
        renderer(scene, "vpl_culled:source=shadow_map:lights=400", square_image(8, 3)),
        "reflective shadow map: only spots, directional lights and the environment can have one, "
        "and something else emits",
        Error);
    const auto refused = [&](void (*spoil)(VirtualLightOptions&), const char* why) {
        VirtualLightOptions options;
        spoil(options);
        CHECK_THROWS_WITH_AS(VirtualLightRenderer(scene, square_image(8, 3), options,
                                                  make_sampler(UniformOptions{}, scene->lights())),
                             why, Error);
    };
    refused([](auto& o) { o.tile = 0; }, "tile is not in [1, 64]");
    refused([](auto& o) { o.interleave = 3; }, "interleave is not 1, 2, 4 or 8");
    refused([](auto& o) { o.light_paths = 0; }, "lights is not in [1, 67108864]");
    refused([](auto& o) { o.range.exposure = -1.0f; },
            "exposure is -1.000000, wanted finite and above 0");
    CHECK_THROWS_WITH_AS(VirtualLightRenderer(nullptr, square_image(8, 3), {}, nullptr),
                         "renderer: there is no scene", Error);
    const auto too_many =
        renderer(scene, "vpl_culled:shadows=maps:points=1:lights=1000000", square_image(8, 3));
    CHECK_THROWS_AS(too_many->render_pass(), Error);

    auto empty = std::make_shared<Scene>();
    empty->commit();
    auto faint = std::make_shared<Scene>();
    faint->add_material(diffuse(0.5f));
    Shape wall;
    wall.add_level_square({0, -1, 0}, 1.0f, true);
    faint->add_mesh(wall.mesh("wall", 0));
    faint->add_point_light({0, 0, 0}, {0, 0, 0});
    faint->commit();
    for (const auto& dark : {empty, faint}) {
        const auto r = renderer(dark, "vpl_culled", square_image(8, 3));
        CHECK(r->render_pass());
        CHECK(render_support::luminance(r->image()[0]) == 0.0);
    }
}
