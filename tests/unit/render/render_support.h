#pragma once

#include "unit/statistics.h"

#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The parts from which the renderer's tests build their scenes.

namespace render_support {

using namespace lightcull;

inline constexpr double kPi = 3.14159265358979323846;

/// A mesh that owns its arrays.
struct Shape {
    std::vector<float3> positions;
    std::vector<std::uint32_t> indices;

    /// Adds a quad whose corners run anticlockwise, seen from the front.
    void add_quad(float3 a, float3 b, float3 c, float3 d) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        positions.insert(positions.end(), {a, b, c, d});
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
    }

    /// Adds a horizontal square about (x, y, z), facing up or down.
    void add_level_square(float3 center, float half_edge, bool up) {
        const float h = half_edge;
        const auto [x, y, z] = center;
        if (up) {
            add_quad({x - h, y, z + h}, {x + h, y, z + h}, {x + h, y, z - h}, {x - h, y, z - h});
        } else {
            add_quad({x - h, y, z - h}, {x + h, y, z - h}, {x + h, y, z + h}, {x - h, y, z + h});
        }
    }

    /// Adds a sphere that faces outwards.
    void add_sphere(float3 center, float radius, std::uint32_t rows) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        const std::uint32_t columns = 2 * rows;
        for (std::uint32_t j = 0; j <= rows; ++j) {
            const double theta = kPi * j / rows;
            for (std::uint32_t i = 0; i < columns; ++i) {
                const double phi = 2.0 * kPi * i / columns;
                positions.push_back(
                    {center.x + radius * static_cast<float>(std::sin(theta) * std::cos(phi)),
                     center.y + radius * static_cast<float>(std::cos(theta)),
                     center.z - radius * static_cast<float>(std::sin(theta) * std::sin(phi))});
            }
        }
        for (std::uint32_t j = 0; j < rows; ++j) {
            for (std::uint32_t i = 0; i < columns; ++i) {
                const std::uint32_t a = first + j * columns + i;
                const std::uint32_t b = first + j * columns + (i + 1) % columns;
                if (j > 0) indices.insert(indices.end(), {a, a + columns, b});
                if (j + 1 < rows) indices.insert(indices.end(), {b, a + columns, b + columns});
            }
        }
    }

    Mesh mesh(std::string name, MaterialId material, const Emission& emission = {}) const {
        Mesh m;
        m.name = std::move(name);
        m.positions = positions;
        m.indices = indices;
        m.material = material;
        m.emission = emission;
        return m;
    }
};

inline Material diffuse(float albedo) {
    Material m;
    m.base_color = {albedo, albedo, albedo};
    return m;
}

inline Material metal(float roughness, float base_color = 1.0f) {
    Material m = diffuse(base_color);
    m.kind = MaterialKind::kMetallicRoughness;
    m.metallic = 1.0f;
    m.roughness = roughness;
    return m;
}

/// A glossy material, half of it metal.
inline Material gloss(float roughness) {
    Material m = metal(roughness, 0.8f);
    m.metallic = 0.5f;
    return m;
}

inline Emission emission(float radiance) {
    Emission e;
    e.radiance = {radiance, radiance, radiance};
    return e;
}

inline Environment constant_environment(float radiance) {
    return {{1, 1, {{radiance, radiance, radiance}}}, {1, 1, 1}, 0.0f};
}

inline Camera look(float3 origin, float3 target, float vertical_fov, float3 up = {0, 1, 0}) {
    Camera c;
    c.origin = origin;
    c.target = target;
    c.up = up;
    c.vertical_fov = vertical_fov;
    return c;
}

/// A room of one material, in it a ball of another one under a lamp.
inline std::shared_ptr<Scene> ball_under_lamp(const Shape& room, const Material& of_ball,
                                              float vertical_fov = 0.7f) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.6f));
    scene->add_material(of_ball);
    Shape ball, lamp;
    ball.add_sphere({0.3f, 0.7f, 0}, 0.5f, 8);
    lamp.add_level_square({0.5f, 2.5f, 0.5f}, 0.3f, false);
    scene->add_mesh(room.mesh("room", 0));
    scene->add_mesh(ball.mesh("ball", 1));
    scene->add_mesh(lamp.mesh("lamp", 0, emission(20.0f)));
    scene->set_camera(look({4, 2.5f, 5}, {0, 0.8f, 0}, vertical_fov));
    return scene;
}

inline std::shared_ptr<const Scene> committed(std::shared_ptr<Scene> scene) {
    scene->commit();
    return scene;
}

inline RenderSettings square_image(std::uint32_t edge, std::uint32_t max_depth) {
    RenderSettings settings;
    settings.width = settings.height = edge;
    settings.max_depth = max_depth;
    return settings;
}

inline double luminance(float3 c) {
    return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) +
           0.0722 * static_cast<double>(c.z);
}

/// The mean luminance of each block of pixels, and last of the image, over many passes. The
/// variance is that among passes, so that pixels may depend on each other.
inline std::vector<statistics::Estimate> render_blocks(const std::shared_ptr<const Scene>& scene,
                                                       const RenderSettings& settings,
                                                       std::unique_ptr<LightSampler> sampler,
                                                       std::uint32_t passes,
                                                       std::uint32_t block_edge) {
    const std::uint32_t columns = settings.width / block_edge;
    const std::uint32_t blocks = columns * (settings.height / block_edge);
    std::vector<statistics::Accumulator> accumulators(blocks + 1);
    std::vector<double> before(blocks + 1, 0.0);
    Renderer renderer(scene, settings, std::move(sampler));
    for (std::uint32_t pass = 1; pass <= passes; ++pass) {
        renderer.render_pass();
        const std::vector<float3> image = renderer.image();
        std::vector<double> sums(blocks + 1, 0.0);
        for (std::uint32_t i = 0; i < image.size(); ++i) {
            const std::uint32_t x = i % settings.width, y = i / settings.width;
            const double value = luminance(image[i]) * pass;
            sums[y / block_edge * columns + x / block_edge] += value / (block_edge * block_edge);
            sums[blocks] += value / static_cast<double>(image.size());
        }
        for (std::uint32_t b = 0; b <= blocks; ++b) accumulators[b].add(sums[b] - before[b]);
        before = std::move(sums);
    }
    std::vector<statistics::Estimate> estimates;
    estimates.reserve(accumulators.size());
    for (const auto& a : accumulators) estimates.push_back(a.estimate());
    return estimates;
}

/// The mean luminance of the image alone, over many passes.
inline statistics::Estimate render_mean(const std::shared_ptr<const Scene>& scene,
                                        const RenderSettings& settings,
                                        std::string_view sampler = "power",
                                        std::uint32_t passes = 64) {
    return render_blocks(scene, settings, make_scene_sampler(sampler, *scene, settings), passes,
                         settings.width)
        .back();
}

/// A sampler that passes all calls on to another, for those that change one of them.
class ForwardingSampler : public LightSampler {
  public:
    explicit ForwardingSampler(std::unique_ptr<LightSampler> inner) : inner_(std::move(inner)) {}

    void begin_pass(std::uint64_t pass) override { inner_->begin_pass(pass); }
    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return inner_->pass(number);
    }
    LightUpdate update(Span<const Light> lights, float max_growth) override {
        return inner_->update(lights, max_growth);
    }
    Selection select(const ShadingPoint& point, float u) const noexcept override {
        return inner_->select(point, u);
    }
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        inner_->select(points, u, selections);
    }
    using LightSampler::prob;
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        return inner_->prob(point, receipt, light);
    }
    std::uint32_t set_count() const noexcept override { return inner_->set_count(); }

  private:
    std::unique_ptr<LightSampler> inner_;
};

}  // namespace render_support
