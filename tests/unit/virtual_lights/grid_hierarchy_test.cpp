#include "base/random.h"
#include "unit/render/render_support.h"
#include "virtual_lights/grid/grid_lighting.h"
#include "virtual_lights/paths/light_paths.h"
#include "virtual_lights/view/a_trous.h"

#include <doctest/doctest.h>

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

using namespace render_support;
using lightcull::GridBuild;
using lightcull::GridHierarchy;
using lightcull::VirtualLight;

namespace {

constexpr float kAlpha = 1.3f;

/// A closed room with a ball and a shelf, and virtual lights on all of it.
class Room {
  public:
    explicit Room(std::uint32_t paths, std::uint32_t edge = 32)
        : settings_(square_image(edge, 4)), scene_(make()), camera_(scene_->camera(), edge, edge) {
        scene_->commit();
        view = trace_camera_view(data_of(*scene_), settings_, PassRays(camera_, settings_, 1));
        const EmissionTable emission(data_of(*scene_));
        lights = virtual_lights(data_of(*scene_), emit(emission, paths, 1), 2, 1);
    }

    std::vector<V3f> by_grid(const std::string& options, std::uint64_t key = 7) {
        const auto parsed = parse_virtual_light_method("vpl_grid" + options);
        const GridHierarchy hierarchy(lights, parsed.alpha, parsed.grid_build);
        std::vector<V3f> pixels(view.hit.size(), V3f(0.0f));
        counts =
            add_grid_lighting({*data_of(*scene_).ray_tracer, camera_, view, parsed, key, nullptr},
                              lights, hierarchy, pixels);
        return pixels;
    }
    std::vector<V3f> by_all(const std::string& options) const {
        const auto parsed = parse_virtual_light_method("vpl_all" + options);
        const RandomRanges ranges(1.0f, 1);
        std::vector<V3f> pixels(view.hit.size(), V3f(0.0f));
        add_tiled_lighting({*data_of(*scene_).ray_tracer, camera_, view, parsed, 7, nullptr},
                           lights, Acceptance(parsed.method, ranges), pixels);
        return pixels;
    }

    CameraView view;
    std::vector<VirtualLight> lights;
    LightingCounts counts;

  private:
    static std::shared_ptr<Scene> make() {
        auto scene = std::make_shared<Scene>();
        scene->add_material(diffuse(0.6f));
        Shape room;
        room.add_level_square({0, 0, 0}, 2.0f, true);
        room.add_quad({-2, 0, 2}, {-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2});
        room.add_quad({-2, 0, -2}, {2, 0, -2}, {2, 3, -2}, {-2, 3, -2});
        room.add_level_square({0, 3, 0}, 2.0f, false);
        room.add_quad({2, 0, -2}, {2, 0, 2}, {2, 3, 2}, {2, 3, -2});
        room.add_quad({2, 0, 2}, {-2, 0, 2}, {-2, 3, 2}, {2, 3, 2});
        room.add_level_square({-0.8f, 1.2f, -0.8f}, 0.8f, true);
        room.add_sphere({0.3f, 0.7f, 0}, 0.5f, 12);
        scene->add_mesh(room.mesh("room", 0));
        scene->add_point_light({1, 2, 1}, {5, 4, 3});
        scene->set_camera(look({1.8f, 2.3f, 1.8f}, {-0.3f, 0.9f, -0.3f}, 1.4f));
        return scene;
    }

    RenderSettings settings_;
    std::shared_ptr<Scene> scene_;
    CameraRays camera_;
};

double mean_luminance_of(const std::vector<V3f>& pixels) {
    double sum = 0.0;
    for (const V3f& p : pixels) sum += static_cast<double>(lightcull::luminance(p));
    return sum / static_cast<double>(pixels.size());
}

/// The mean relative difference, by luminance, over pixels that are not black.
double difference(const std::vector<V3f>& a, const std::vector<V3f>& b) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const float right = lightcull::luminance(b[i]);
        if (!(right > 0.0f)) continue;
        sum += static_cast<double>(std::fabs(lightcull::luminance(a[i]) - right) / right);
        count += 1.0;
    }
    return sum / count;
}

}  // namespace

TEST_CASE("grid: blending is a partition of unity") {
    const Room room(2000, 8);
    const GridHierarchy grid(room.lights, kAlpha, GridBuild::kGather);
    CHECK(grid.level_count() >= 4);
    lightcull::RandomStream random(1);
    for (int i = 0; i < 100000; ++i) {
        const float distance = std::exp2(20.0f * random.next() - 12.0f);
        double sum = 0.0;
        for (std::uint32_t level = 0; level <= grid.level_count(); ++level) {
            const float share = grid.blend(level, distance);
            CHECK(share >= 0.0f);
            sum += static_cast<double>(share);
            const float r = grid.radius(level);
            if (level > 0 && distance <= 0.5f * r) CHECK(share == 0.0f);
            if (level < grid.level_count() && distance >= 2.0f * r) CHECK(share == 0.0f);
        }
        CHECK(sum == doctest::Approx(1.0).scale(0.0).epsilon(1e-5));
    }
    for (std::uint32_t level = 0; level <= grid.level_count(); ++level) {
        const bool has_hat = level > 0 && level < grid.level_count();
        CHECK(grid.blend(level, grid.radius(level)) == doctest::Approx(1.0));
        if (has_hat) CHECK(grid.blend(level, 0.75f * grid.radius(level)) == doctest::Approx(0.5));
        CHECK(grid.radius(level) == doctest::Approx(grid.radius(0) * std::exp2(level)));
    }
}

TEST_CASE("grid: every level keeps power, centre and normals, and is smaller than the one below") {
    const Room room(30000, 8);
    Imath::V3d power(0.0), centre(0.0), normal(0.0);
    for (const VirtualLight& light : room.lights) {
        const auto weight = static_cast<double>(lightcull::luminance(light.strength));
        power += Imath::V3d(light.strength);
        centre += Imath::V3d(light.position) * weight;
        normal += Imath::V3d(light.normal) * weight;
    }
    for (const GridBuild build : {GridBuild::kGather, GridBuild::kScatter}) {
        const GridHierarchy grid(room.lights, 1.0f, build);
        std::size_t below = room.lights.size() / 2;
        for (std::uint32_t level = 1; level <= grid.level_count(); ++level) {
            Imath::V3d p(0.0), c(0.0), n(0.0);
            for (const GridLight& light : grid.level(level)) {
                const auto weight = static_cast<double>(lightcull::luminance(light.strength));
                p += Imath::V3d(light.strength);
                c += Imath::V3d(light.position) * weight;
                n += Imath::V3d(light.normal) * weight;
                CHECK(light.normal.length() < 1.0f + 1e-5f);
            }
            CHECK((p - power).length() < 1e-5 * power.length());
            CHECK((c - centre).length() < 1e-5 * centre.length());
            CHECK((n - normal).length() < 1e-5 * normal.length());
            CHECK(grid.level(level).size() < below);
            below = grid.level(level).size() + 1;
        }
        CHECK(grid.level(grid.level_count()).size() <= 8);
    }
}

TEST_CASE("grid: a light stands for others by their variance and the spread of their normals") {
    lightcull::RandomStream random(5);
    LightMoments sum;
    std::vector<V3f> normals;
    for (int i = 0; i < 20000; ++i) {
        const float z = 2.0f * random.next() - 1.0f;
        const float angle = 6.2831853f * random.next(), s = std::sqrt(1.0f - z * z);
        VirtualLight light{};
        light.position = V3f(random.next() * 2.0f, random.next(), 5.0f);
        light.normal = V3f(s * std::cos(angle), s * std::sin(angle), z);
        light.strength = V3f(1.0f);
        normals.push_back(light.normal);
        sum.add(moments_of(light), 1.0);
    }
    const GridLight all = light_of(sum);
    CHECK(all.position.x == doctest::Approx(1.0).scale(0.0).epsilon(0.02));
    CHECK(all.deviation.x == doctest::Approx(2.0 / std::sqrt(12.0)).scale(0.0).epsilon(0.02));
    CHECK(all.deviation.y == doctest::Approx(1.0 / std::sqrt(12.0)).scale(0.0).epsilon(0.02));
    CHECK(all.deviation.z == doctest::Approx(0.0));
    // The normals point anywhere alike, which gives a quarter of the peak.
    CHECK(intensity(all, V3f(0, 1, 0)).x == doctest::Approx(5000.0).scale(0.0).epsilon(0.03));

    VirtualLight flat{};
    flat.normal = V3f(0, 1, 0);
    flat.strength = V3f(2.0f);
    const GridLight one = light_of(moments_of(flat));
    CHECK(intensity(one, V3f(0, 0.6f, 0.8f)).x == doctest::Approx(1.2));
    CHECK(intensity(one, V3f(0, -0.6f, 0.8f)).x == doctest::Approx(0.0).epsilon(1e-3));
}

TEST_CASE("grid: as alpha grows, vpl_grid becomes vpl_all") {
    Room room(3000);
    const std::vector<V3f> all = room.by_all(":shadows=none");
    const double coarse = difference(room.by_grid(":shadows=none:alpha=0.5"), all);
    const std::uint64_t few = room.counts.accepted;
    const double fine = difference(room.by_grid(":shadows=none:alpha=4"), all);
    CHECK(few < room.counts.accepted);
    CHECK(coarse < 0.3);
    CHECK(fine < 0.3 * coarse);
    CHECK(difference(room.by_grid(":shadows=none:alpha=1e6"), all) < 1e-5);
}

TEST_CASE("grid: a point finds every light that gives it something") {
    Room room(3000);
    const GridHierarchy grid(room.lights, 0.7f, GridBuild::kGather);
    const GridFinder finder(room.lights, grid);
    std::size_t wanted = 0, found = 0;
    for (std::size_t pixel = 0; pixel < room.view.hit.size(); pixel += 7) {
        if (room.view.hit[pixel] == 0) continue;
        const Surface& surface = room.view.surfaces[pixel];
        std::vector<int> times(finder.count(), 0);
        finder.for_each({to_float3(surface.position), to_float3(surface.normal)},
                        [&](std::uint32_t number, GridFinder::Found) {
                            ++times[number];
                            ++found;
                        });
        for (std::uint32_t number = 0; number < finder.count(); ++number) {
            CHECK(times[number] <= 1);
            const auto [level, index] = finder[number];
            const V3f place =
                level == 0 ? room.lights[index].position : grid.level(level)[index].position;
            const V3f way = place - surface.position;
            if (!(way.dot(surface.normal) > 0.0f) || !(grid.blend(level, way.length()) > 0.0f)) {
                continue;
            }
            ++wanted;
            if (times[number] != 1) FAIL("light missed");
        }
    }
    CHECK(wanted > 1000);
    CHECK(found < 3 * wanted);
}

TEST_CASE("grid: shadow samples give the shadows of all lights in the mean") {
    Room room(500, 24);
    const std::vector<V3f> all = room.by_all(":shadows=rays");
    const std::vector<V3f> unshadowed = room.by_all(":shadows=none");
    constexpr int kPasses = 200;
    std::vector<V3f> mean(all.size(), V3f(0.0f));
    for (int p = 0; p < kPasses; ++p) {
        const auto pixels =
            room.by_grid(":alpha=1e6:samples=8:filter=off", 100 + static_cast<std::uint64_t>(p));
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += pixels[i] / kPasses;
    }
    CHECK(difference(unshadowed, all) > 0.08);
    CHECK(mean_luminance_of(mean) ==
          doctest::Approx(mean_luminance_of(all)).scale(0.0).epsilon(0.005));
    CHECK(difference(mean, all) < 0.015);
}

TEST_CASE("grid: taken together, lights keep about the shadows that they cast each by itself") {
    Room room(5000, 24);
    const std::vector<V3f> all = room.by_all(":shadows=rays");
    constexpr int kPasses = 20;
    std::vector<V3f> mean(all.size(), V3f(0.0f));
    for (int p = 0; p < kPasses; ++p) {
        const auto pixels =
            room.by_grid(":samples=8:filter=off", 100 + static_cast<std::uint64_t>(p));
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += pixels[i] / kPasses;
    }
    CHECK(difference(room.by_all(":shadows=none"), all) > 0.08);
    CHECK(difference(mean, all) < 0.04);
}

TEST_CASE("grid: the same bits for any number of threads") {
    Room room(3000);
    std::vector<std::vector<V3f>> images;
    for (const int threads : {1, 2}) {
        tbb::task_arena arena(threads);
        arena.execute([&] { images.push_back(room.by_grid("")); });
    }
    CHECK(images[0] == images[1]);
}

TEST_CASE("a-trous: noise is smoothed, an edge of the geometry stays, and what is no number") {
    Room room(10, 64);
    std::vector<float> values(room.view.hit.size(), -1.0f);
    lightcull::RandomStream random(3);
    // The truth is bright on the floor and dark on the walls, and the noise is 0.1.
    const auto truth = [&](std::size_t i) {
        return room.view.surfaces[i].normal.y > 0.9f ? 0.8f : 0.2f;
    };
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (room.view.hit[i] != 0) values[i] = truth(i) + 0.2f * (random.next() - 0.5f);
    }
    filter_a_trous(room.view, values);
    double squares = 0.0, count = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (room.view.hit[i] == 0) {
            CHECK(values[i] == -1.0f);
            continue;
        }
        const auto off = static_cast<double>(values[i] - truth(i));
        squares += off * off;
        count += 1.0;
    }
    CHECK(std::sqrt(squares / count) < 0.025);  // before the filter: 0.058
}
