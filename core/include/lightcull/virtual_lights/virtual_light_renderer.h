#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>
#include <lightcull/render/scene.h>
#include <lightcull/samplers.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace lightcull {

/// How the light of virtual lights is summed.
enum class VirtualLightMethod {
    kAll,      ///< every light at every pixel
    kCulled,   ///< stochastic tiled lighting ([TH16] section 4, [TH17])
    kClamped,  ///< tiled lighting with constant ranges ([TH16] appendix A): biased, for comparison
    kGrid,     ///< lighting grid hierarchy ([LY19]): far lights are taken together
};

/// Where light paths start.
enum class VirtualLightSource {
    kPaths,      ///< at any emitter, in proportion to power
    kShadowMap,  ///< at the texels of a reflective shadow map of each spot, and of one of the
                 ///< environment, seen from the directions that it shines from: as of a directional
                 ///< light where that is a sun
};

enum class VirtualShadows {
    kNone,
    kRays,
    kMaps,  ///< imperfect shadow maps ([TH16] section 4.3); not of kGrid, and of 2^18 lights at
            ///< most
};

/// What encloses the places where a virtual light matters.
enum class BoundingVolume {
    kSpheroid,      ///< [TH17] Eqs. 13 to 15, of a glossy light; of a diffuse one a sphere that its
                    ///< position lies off the centre of
    kSphereAround,  ///< the sphere about that spheroid
    kSphereAtLight,  ///< about the light, for its largest intensity ([TH16])
};

/// How the lights that may matter to a pixel are found.
enum class VirtualLightCulling {
    kTiles,  ///< a list for each tile of pixels, by its frustum in two depths ([TH17] section 5)
    kSplatting,  ///< the rectangle of pixels that the box around a light's volume covers
                 ///< (Dachsbacher and Stamminger 2006), for comparison; without shadows
};

/// What the levels of a lighting grid hierarchy above the first are made from.
enum class GridBuild {
    kGather,   ///< the lights of level 1 ([LY19] section 3.1)
    kScatter,  ///< the virtual lights again, for comparison
};

struct VirtualLightOptions {
    VirtualLightMethod method = VirtualLightMethod::kCulled;
    VirtualLightSource source = VirtualLightSource::kPaths;
    /// Light paths, or texels of a shadow map (then a square number): each gives a virtual light or
    /// two for each of its bounces.
    std::uint32_t light_paths = 65536;
    /// Of kCulled and kClamped. expected_accepted: virtual lights per pixel in the first pass, if
    /// no error_bound ([TH16] Eq. 6, appendix A) is given.
    RangeOptions range = RangeOptions::with_expected_accepted(32.0f);
    /// Pixels of a square of that many a side share the lights among them: 1, 2, 4 or 8.
    std::uint32_t interleave = 8;
    VirtualShadows shadows = VirtualShadows::kRays;
    BoundingVolume volume = BoundingVolume::kSpheroid;
    VirtualLightCulling culling = VirtualLightCulling::kTiles;
    /// Of kTiles: pixels along the edge of a tile, of those that have the same lights.
    std::uint32_t tile = 16;
    /// A cross-bilateral filter over what virtual lights give; of kGrid an a-trous one over
    /// shadows.
    bool filter = true;

    // Of shadows by maps:
    std::uint32_t map_points = 8192;  ///< points of the scene for the map of each light
    bool map_culling = true;          ///< only of those within its range

    // Of kGrid:
    float alpha = 2.0f;                ///< r_l / h_l: how far each light is taken by itself
    std::uint32_t shadow_samples = 4;  ///< shadow rays per pixel
    GridBuild grid_build = GridBuild::kGather;
};

/// Throws Error, with a message that names the option, if one makes no sense. Whatever takes
/// options does this first.
LIGHTCULL_EXPORT void check_virtual_light_options(const VirtualLightOptions& options);

/// Options by their description: a name, then options, as in "vpl_culled",
/// "vpl_culled:lights=65536:shadows=none", "vpl_clamped:error_bound=0.01". Names: vpl_all (1024
/// lights, no interleaving and no filter unless told), vpl_culled, vpl_clamped, vpl_grid. Options:
/// lights; source (paths | shadow_map); shadows (rays | none | maps); filter (on | off); interleave
/// (not of vpl_grid); error_bound (a number or auto), accepted, exposure (vpl_culled, vpl_clamped);
/// volume (spheroid | sphere_around | sphere_at_light; vpl_culled); culling (tiles | splatting),
/// tile (1 to 64; vpl_culled, vpl_clamped); alpha, samples, build (gather | scatter; vpl_grid);
/// points, map_culling (on | off; shadows=maps). Throws Error for what is unknown or makes no
/// sense.
LIGHTCULL_EXPORT VirtualLightOptions parse_virtual_light_method(std::string_view description);

/// What virtual lights took, over all passes. Seconds are those of processors, all threads of the
/// process together.
struct VirtualLightStats {
    std::uint64_t lights = 0;  ///< generated
    double generation_seconds = 0.0;
    double build_seconds = 0.0;     ///< of kGrid its hierarchy, of shadows by maps the maps
    double lighting_seconds = 0.0;  ///< ranges, culling, shading, shadows, and of kGrid its tree to
                                    ///< find lights by and its filter
    double filter_seconds = 0.0;
    std::uint64_t pixels = 0;  ///< that show a surface
    std::uint64_t listed = 0;  ///< lights in the lists of the pixels' tiles, or that the traversal
                               ///< of kGrid found, over all pixels
    std::uint64_t accepted = 0;  ///< of them, those in whose range the pixel was; of kGrid those
                                 ///< that gave it something
    std::uint64_t shadow_rays = 0;
    double error_bound = 0.0;      ///< of kCulled and kClamped, given or found in the first pass
    std::uint64_t map_points = 0;  ///< points splatted into shadow maps
};

/// What a pass of virtual lights takes of memory at most, bytes; neither the scene nor direct light
/// is in it.
struct VirtualLightMemory {
    std::size_t lights = 0;  ///< light paths, virtual lights and all that is made of them
    std::size_t image = 0;   ///< the surfaces that pixels show, and their light
};

/// Virtual lights of a pixel, as in VirtualLightStats.
struct LightsOfPixel {
    std::uint32_t listed = 0, accepted = 0;
};

/// A progressive renderer: emission and direct light as Renderer has them, and what bounces by
/// virtual lights, new ones in each pass. The result depends on the scene, the settings, the
/// options and the sampler, never on the number of threads.
///
/// Light from a virtual light falls off as 1 / max(d^2, s^2 / n), with s the extent of all n
/// virtual lights: nearer than that they are too few for their patch of the surface. On surfaces
/// with interpolated normals a virtual light takes its cosine from those.
class LIGHTCULL_EXPORT VirtualLightRenderer {
  public:
    /// settings.max_depth: 3 to 5, for one to three bounces. `sampler` is for direct light. Throws
    /// Error if the settings or options make no sense, if a material is a perfect mirror, whose
    /// light no virtual light can send on, or if light paths are to start at shadow maps and
    /// something emits that has none.
    VirtualLightRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                         const VirtualLightOptions& options, std::unique_ptr<LightSampler> sampler);
    ~VirtualLightRenderer();

    /// As Renderer::render_pass().
    bool render_pass(const std::atomic<bool>* cancel = nullptr);
    /// As Renderer::image().
    std::vector<float3> image() const;
    /// sampler_seconds, selection_seconds and selections are those of direct light.
    RenderStats stats() const;
    const VirtualLightStats& virtual_light_stats() const noexcept;
    /// Row by row, over all passes; all 0 with kGrid.
    const std::vector<LightsOfPixel>& lights_of_pixels() const noexcept;
    /// Of direct light.
    RendererMemory memory_size() const noexcept;
    /// An estimate, by the lights that some of the light paths give.
    VirtualLightMemory virtual_light_memory() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lightcull
