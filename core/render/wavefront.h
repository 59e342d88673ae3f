#pragma once

#include "render/pass_rays.h"
#include "render/pixel_numbers.h"
#include "render/ray.h"
#include "render/surface.h"
#include "render/tiles.h"
#include "render/vec.h"

#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>
#include <lightcull/samplers.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The data that all tiles of a pass share.
struct Pass {
    const SceneData& scene;
    const RenderSettings& settings;
    PassRays camera_rays;
    const LightSelector& sampler;
    const VertexCulling* vertex_culling;  ///< vertex culling of the sampler; may be null
    std::uint64_t number;                 ///< number of the pass
    std::uint64_t key;                    ///< a hash of the seed and the number
    std::uint64_t numbers_key;            ///< key of PixelNumbers
    const std::atomic<bool>* cancel;      ///< may be null
    V3f* pixels;           ///< place where the samples go: height * width, black at first
    V3f* emission;         ///< another for the part that the camera sees of emitters; may be null
    bool reports = false;  ///< the sampler is told what shadow rays find
    std::uint32_t one_in = 1;     ///< one of so many blocks of pixels is traced
    float last_ray_share = 1.0f;  ///< share of paths that trace their last edge where it leaves a
                                  ///< broad BSDF and is there for MIS alone, (0, 1]

    bool cancelled() const noexcept {
        return cancel != nullptr && cancel->load(std::memory_order_relaxed);
    }
};

/// Traces one path per pixel of a tile, all of them one edge at a time:
///     start(); while (advance()) { choose a light for each of points(); shade(); }
/// which adds a sample to each pixel of the tile. The buffers are kept from tile to tile.
class Wavefront {
  public:
    void start(const Pass& pass, const Tile& tile);

    /// Traces the next edge of all paths. False if there are no vertices to shade: the paths have
    /// ended.
    bool advance();

    /// The vertices that the paths have come to, and the random numbers that light selection is to
    /// take there.
    Span<const ShadingPoint> points() const noexcept { return points_; }
    Span<const float> selection_numbers() const noexcept { return selection_u_; }
    /// The place where the selections for points() go; there are none at first.
    Span<Selection> selections() noexcept { return selections_; }

    /// Adds the light that falls on the vertices, and scatters the paths.
    void shade();

    /// The rays that advance(), and the shadow rays that shade(), has traced last.
    Span<const Ray> rays() const noexcept { return rays_; }
    Span<const Ray> shadow_rays() const noexcept { return shadow_rays_; }

    /// The number of rays traced since it was last asked for.
    std::uint64_t take_ray_count() noexcept;

    /// The bytes of all buffers, for each path that has a vertex and a shadow ray.
    static constexpr std::size_t bytes_per_path() noexcept {
        return 2 * (sizeof(Path) + sizeof(Ray)) + sizeof(Hit) + sizeof(std::uint32_t) +
               sizeof(Surface) + sizeof(ShadingPoint) + sizeof(float) + sizeof(Selection) +
               sizeof(Ray) + sizeof(Contribution) + sizeof(std::uint8_t) + sizeof(LightOutcome) +
               sizeof(V3f) + sizeof(std::uint64_t);
    }

  private:
    /// A path whose next ray is the one of the same index.
    struct Path {
        std::uint32_t pixel;
        V3f throughput;
        // Members for MIS, about the vertex that the ray leaves:
        float bsdf_pdf;  ///< density of the ray's direction, times the share of such rays
        ShadingPoint point;
        Receipt receipt;
    };
    /// The light that a shadow ray brings if nothing is in its way.
    struct Contribution {
        std::uint32_t pixel;
        std::uint32_t vertex;  ///< vertex whose selected light it is; kNone: the environment
        V3f value;
    };
    /// A direction to an emitter or the environment, and the light that it brings.
    struct LightSample {
        Ray shadow_ray;
        V3f value{0.0f};  ///< light that it brings; 0: not worth a ray
    };

    void intersect();
    void add_emission();
    V3f escaped(const Path& path, const Ray& ray) const noexcept;
    V3f emitted_by(std::uint32_t light, const Path& path, const Ray& ray,
                   const Hit& hit) const noexcept;
    float hit_weight(const Path& path, float light_pdf) const noexcept;
    void sort_along_curve();
    void make_vertices();
    std::uint32_t set_of(std::size_t vertex) const noexcept;
    void add_direct_light();
    LightSample sample_light(std::size_t vertex, const PixelNumbers& numbers) const noexcept;
    LightSample sample_environment(std::size_t vertex, const PixelNumbers& numbers) const noexcept;
    void report_visibility();
    float ray_share(const Surface& surface) const noexcept;
    void scatter();

    bool needs_selection() const noexcept;
    bool has_lights() const noexcept;
    const Path& path_of(std::size_t vertex) const noexcept { return paths_[order_[vertex]]; }
    PixelNumbers numbers_of(std::uint32_t pixel) const noexcept { return {numbers_, pixel}; }

    const Pass* pass_ = nullptr;
    PixelNumbers::Shared numbers_{0, 0, 0};
    std::uint32_t depth_ = 0;  ///< edges of the paths so far, the rays under way included
    std::uint64_t rays_traced_ = 0;

    // The paths, by ray.
    std::vector<Path> paths_, next_paths_;
    std::vector<Ray> rays_, next_rays_;
    std::vector<Hit> hits_;
    // The vertices where a path goes on: order_ leads to the path.
    std::vector<std::uint32_t> order_;
    std::vector<Surface> surfaces_;
    std::vector<ShadingPoint> points_;
    std::vector<float> selection_u_;
    std::vector<Selection> selections_;
    // The shadow rays.
    std::vector<Ray> shadow_rays_;
    std::vector<Contribution> contributions_;
    std::vector<std::uint8_t> occluded_;
    std::vector<LightOutcome> outcomes_;
    // Room for sorting.
    std::vector<V3f> positions_;
    std::vector<std::uint64_t> sort_keys_;
};

}  // namespace lightcull
