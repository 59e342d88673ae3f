#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>
#include <lightcull/render/scene.h>
#include <lightcull/samplers.h>
#include <lightcull/span.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace lightcull {

/// The technique that finds the light which falls on a surface.
enum class DirectLight {
    kMis,     ///< light and BSDF sampling, combined by the balance heuristic
    kLights,  ///< light sampling alone
    kBsdf,    ///< BSDF sampling alone (points and spots are never found)
};

struct RenderSettings {
    std::uint32_t width = 320, height = 240;  ///< pixels
    std::uint32_t max_depth = 2;  ///< longest path, in edges: 1 sees emitters only, 2 direct light
    std::uint32_t rr_depth = 5;   ///< Russian roulette from this depth on
    std::uint64_t seed = 0;
    std::uint32_t threads = 0;  ///< largest number of threads; 0: as many as the machine has
    DirectLight direct_light = DirectLight::kMis;
    bool even_numbers = true;  ///< random numbers of a pixel cover their ranges evenly from pass to
                               ///< pass; false: passes are independent, for statistics of one
    bool emission_apart = false;  ///< keep what the camera sees of emitters in a film of its own,
                                  ///< for Renderer::emission() and lit()
    bool hide_emitters = false;   ///< the camera sees neither triangles that emit, through which
                                  ///< its rays go on, nor the environment; mirrors do
};

struct RenderStats {
    std::uint64_t passes = 0;        ///< samples per pixel so far
    double seconds = 0.0;            ///< wall time of render_pass() and restart(), the sampler's
                                     ///< refits included
    double sampler_seconds = 0.0;    ///< part of `seconds` that refits and selections take
    double selection_seconds = 0.0;  ///< time in LightSampler::select(), summed over threads
    std::uint64_t selections = 0;
    std::uint64_t rays = 0;  ///< camera, shadow and scattered rays
};

/// All that a renderer has come to, after any number of whole passes.
struct RenderState {
    RenderStats stats;
    std::vector<double>
        sums;  ///< sums over the passes, linear RGB, row 0 at the top: height * width * 3
    std::vector<std::uint8_t> learned;  ///< LightSampler::learned() of the sampler
};

/// The memory that a renderer keeps, bytes; the scene is not in it.
struct RendererMemory {
    std::size_t sampler = 0;  ///< the sampler's trees, with all sets of ranges; 0 if it has no
                              ///< SamplerInfo
    std::size_t learned = 0;  ///< what the sampler may still come to by learning, at most
    std::size_t film = 0;     ///< the sums of the passes, and the pass under way
    std::size_t paths = 0;  ///< the paths that are traced at a time, once a pass has been rendered
};

/// A progressive path tracer: each pass adds one sample to every pixel. The result depends on the
/// scene, the settings and the sampler, never on the number of threads.
class LIGHTCULL_EXPORT Renderer {
  public:
    /// Throws Error if the settings make no sense. The sampler is this renderer's alone.
    Renderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
             std::unique_ptr<LightSampler> sampler);
    ~Renderer();

    /// Renders one pass. If `cancel` becomes true meanwhile, the pass is dropped, the image and the
    /// statistics stay what they were, and the answer is false. Throws Error if the scene has been
    /// moved since the image was begun.
    bool render_pass(const std::atomic<bool>* cancel = nullptr);

    /// Begins another image, of the scene as it is after Scene::refit(), with a seed of its own: no
    /// passes yet, and the sampler fitted to where the lights are (LightSampler::update). Other
    /// calls than this throw or tell of the image before, once the scene has been moved. Throws
    /// Error, and changes nothing, where the sampler cannot be updated.
    LightUpdate restart(std::uint64_t seed);

    /// The mean of all passes, linear RGB, row 0 at the top: height * width. Black before the
    /// first pass.
    std::vector<float3> image() const;
    /// The part of image() that the camera sees of emitters and the environment directly, which
    /// does not depend on how lights are sampled, and the rest of it, which does. Both are empty
    /// unless RenderSettings::emission_apart.
    std::vector<float3> emission() const;
    std::vector<float3> lit() const;

    /// Goes on from a state() of a renderer of the same scene, settings and sampler, as if that had
    /// never stopped: the next passes give the same bits. Throws Error if it cannot be one of this
    /// image's, and where emission is kept apart, of which a state knows nothing.
    void restore(const RenderState& state);
    RenderState state() const;

    /// Begins a part of the image, to be added to others: the passes from number `first_pass` on.
    /// Sums and statistics are of the part alone, but stats().passes counts on from first_pass.
    /// learned: LightSampler::learned() of a sampler of this image, from which this one goes on;
    /// empty: from what it knows. Once learning() is false, parts are the same in whatever order
    /// they are rendered.
    void begin_part(std::uint64_t first_pass, Span<const std::uint8_t> learned = {});
    /// True as long as passes depend on those before them: see SamplerInfo::learning().
    bool learning() const noexcept;
    /// The sums over the passes of what emission() is the mean of, as RenderState has those of
    /// image(). Empty unless RenderSettings::emission_apart.
    std::vector<double> emission_sums() const;

    const RenderStats& stats() const noexcept;
    const LightSampler& sampler() const noexcept;
    RendererMemory memory_size() const noexcept;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// First hits of camera rays at about `count` pixels spread over the image, with the normal towards
/// the camera. There are fewer where rays leave the scene.
LIGHTCULL_EXPORT std::vector<ShadingPoint> camera_points(const Scene& scene,
                                                         const RenderSettings& settings,
                                                         std::uint32_t count);

/// What the middle of each pixel shows: the first hits of camera rays, with the normal towards the
/// camera. Row 0 at the top: height * width, of which those are empty whose rays leave the scene.
LIGHTCULL_EXPORT std::vector<std::optional<ShadingPoint>> pixel_points(
    const Scene& scene, const RenderSettings& settings);

/// The points at which the renderer asks `sampler` for lights when paths are `depth` edges long, of
/// one pass, in its order and with its sets. depth 1: what camera rays hit, a point per pixel at
/// most; 2 and 3: after one and two bounces. There are none if the scene has no lights. The paths
/// are traced in the caller's TBB arena.
LIGHTCULL_EXPORT std::vector<ShadingPoint> path_points(const Scene& scene,
                                                       const RenderSettings& settings,
                                                       const LightSampler& sampler,
                                                       std::uint32_t depth);

/// A sampler over the scene's lights by its description (see make_sampler), calibrated on points
/// that paths of this scene meet.
LIGHTCULL_EXPORT std::unique_ptr<LightSampler> make_scene_sampler(std::string_view description,
                                                                  const Scene& scene,
                                                                  const RenderSettings& settings);

}  // namespace lightcull
