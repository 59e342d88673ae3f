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

/// The way in which the light of virtual lights is summed.
enum class VirtualLightMethod {
    kAll,      ///< every light at every pixel
    kCulled,   ///< stochastic tiled lighting ([TH16] section 4, [TH17])
    kClamped,  ///< tiled lighting with constant ranges ([TH16] appendix A): biased, for comparison
    kGrid,     ///< lighting grid hierarchy ([LY19]): far lights are taken together
};

/// The places where light paths start.
enum class VirtualLightSource {
    kPaths,      ///< at any emitter, in proportion to power
    kShadowMap,  ///< at the texels of a reflective shadow map of each spot and directional light,
                 ///< and of one of the environment, seen from the directions that it shines from
};

enum class VirtualShadows {
    kNone,
    kRays,
    kMaps,  ///< imperfect shadow maps ([TH16] section 4.3), for at most 2^18 lights and not for
            ///< kGrid
};

/// The solid that encloses the places where a virtual light matters.
enum class BoundingVolume {
    kSpheroid,       ///< the spheroid of [TH17] Eqs. 13 to 15 for a glossy light; for a diffuse one
                     ///< a sphere that its position lies off the centre of
    kSphereAround,   ///< the sphere about that spheroid
    kSphereAtLight,  ///< a sphere about the light, for its largest intensity ([TH16])
};

/// The way in which the lights that may matter to a pixel are found.
enum class VirtualLightCulling {
    kTiles,  ///< a list for each tile of pixels, by its frustum in two depths ([TH17] section 5)
    kSplatting,  ///< the rectangle of pixels that the box around a light's volume covers
                 ///< (Dachsbacher and Stamminger 2006), for comparison; without shadows
};

/// The source from which the levels of a lighting grid hierarchy above the first are made.
enum class GridBuild {
    kGather,   ///< the lights of level 1 ([LY19] section 3.1)
    kScatter,  ///< the virtual lights again, for comparison
};

struct VirtualLightOptions {
    VirtualLightMethod method = VirtualLightMethod::kCulled;
    VirtualLightSource source = VirtualLightSource::kPaths;
    /// Number of light paths, or of texels of a shadow map (then a square number): each gives a
    /// virtual light or two for each of its bounces.
    std::uint32_t light_paths = 65536;
    /// Ranges of kCulled and kClamped. expected_accepted: virtual lights per pixel in the first
    /// pass, if no error_bound ([TH16] Eq. 6, appendix A) is given.
    RangeOptions range = RangeOptions::with_expected_accepted(32.0f);
    /// Pixels along the edge of a square of pixels that share the lights among them: 1, 2, 4 or 8.
    std::uint32_t interleave = 8;
    VirtualShadows shadows = VirtualShadows::kRays;
    BoundingVolume volume = BoundingVolume::kSpheroid;
    VirtualLightCulling culling = VirtualLightCulling::kTiles;
    /// Pixels along the edge of a tile, whose pixels have the same lights, for kTiles.
    std::uint32_t tile = 16;
    /// Smooths what virtual lights give by a cross-bilateral filter; with kGrid, shadows by an
    /// a-trous one.
    bool filter = true;

    // Options of shadows by maps:
    std::uint32_t map_points = 8192;  ///< points of the scene for the map of each light
    bool map_culling = true;          ///< a map takes only the points within the light's range

    // Options of kGrid:
    float alpha = 2.0f;                ///< r_l / h_l: how far each light is taken by itself
    std::uint32_t shadow_samples = 4;  ///< shadow rays per pixel
    GridBuild grid_build = GridBuild::kGather;
};

/// Throws Error, with a message that names the option, if an option makes no sense. Every function
/// that takes options does this first.
LIGHTCULL_EXPORT void check_virtual_light_options(const VirtualLightOptions& options);

/// Options by their description: a name, then options, as in "vpl_culled",
/// "vpl_culled:lights=65536:shadows=none", "vpl_clamped:error_bound=0.01". Names: vpl_all (1024
/// lights, no interleaving and no filter unless told), vpl_culled, vpl_clamped, vpl_grid. Options:
/// lights; source (paths | shadow_map); shadows (rays | none | maps); filter (on | off); interleave
/// (not of vpl_grid); error_bound (a number or auto), accepted, exposure (vpl_culled, vpl_clamped);
/// volume (spheroid | sphere_around | sphere_at_light; vpl_culled); culling (tiles | splatting),
/// tile (1 to 64; vpl_culled, vpl_clamped); alpha, samples, build (gather | scatter; vpl_grid);
/// points, map_culling (on | off; shadows=maps). The call throws Error for what is unknown or makes
/// no sense.
LIGHTCULL_EXPORT VirtualLightOptions parse_virtual_light_method(std::string_view description);

/// The cost of virtual lights, over all passes. Seconds are those of processors, all threads of the
/// process together.
struct VirtualLightStats {
    std::uint64_t lights = 0;  ///< virtual lights that were generated
    double generation_seconds = 0.0;
    double build_seconds = 0.0;     ///< time to build the hierarchy of kGrid, and the maps of
                                    ///< shadows by maps
    double lighting_seconds = 0.0;  ///< time for ranges, culling, shading, shadows, and with kGrid
                                    ///< its tree to find lights by and its filter
    double filter_seconds = 0.0;
    std::uint64_t pixels = 0;  ///< pixels that show a surface
    std::uint64_t listed = 0;  ///< lights in the lists of the pixels' tiles, or that the traversal
                               ///< of kGrid found, summed over all pixels
    std::uint64_t accepted = 0;  ///< listed lights in whose range the pixel was; with kGrid those
                                 ///< that gave it something
    std::uint64_t shadow_rays = 0;
    double error_bound = 0.0;      ///< error bound of kCulled and kClamped, given or found in the
                                   ///< first pass
    std::uint64_t map_points = 0;  ///< points splatted into shadow maps
};

/// The memory that a pass of virtual lights takes at most, bytes; neither the scene nor direct
/// light is in it.
struct VirtualLightMemory {
    std::size_t lights = 0;  ///< light paths, virtual lights and all that is made of them
    std::size_t image = 0;   ///< the surfaces that pixels show, and their light
    std::size_t kept = 0;    ///< of `image`, what is there before the first pass, and stays
};

/// The numbers of virtual lights of a pixel, as VirtualLightStats counts them.
struct LightsOfPixel {
    std::uint32_t listed = 0, accepted = 0;
};

/// A progressive renderer: emission and direct light as Renderer has them, and what bounces by
/// virtual lights, new ones in each pass. The result depends on the scene, the settings, the
/// options and the sampler, never on the number of threads.
///
/// Light from a virtual light falls off as 1 / max(d^2, s^2 / n), with s the extent of all n
/// virtual lights: nearer than that they are too few for their patch of the surface. On surfaces
/// with interpolated normals a virtual light takes its cosine from these normals.
class LIGHTCULL_EXPORT VirtualLightRenderer {
  public:
    /// settings.max_depth: 3 to 5, for one to three bounces. `sampler` is for direct light. Throws
    /// Error if the settings or options make no sense, if a material is a perfect mirror, whose
    /// light no virtual light can send on, or if light paths are to start at shadow maps and
    /// something emits that has none.
    VirtualLightRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                         const VirtualLightOptions& options, std::unique_ptr<LightSampler> sampler);
    ~VirtualLightRenderer();

    /// Renders one pass, as Renderer::render_pass() does.
    bool render_pass(const std::atomic<bool>* cancel = nullptr);
    /// The mean of all passes, as Renderer::image() gives it.
    std::vector<float3> image() const;
    /// The statistics, of which sampler_seconds, selection_seconds and selections are those of
    /// direct light.
    RenderStats stats() const;
    const VirtualLightStats& virtual_light_stats() const noexcept;
    /// The numbers of lights, pixel by pixel and row by row, over all passes; all 0 with kGrid.
    const std::vector<LightsOfPixel>& lights_of_pixels() const noexcept;
    /// The memory that direct light takes.
    RendererMemory memory_size() const noexcept;
    /// An estimate of the memory, by the lights that some of the light paths give.
    VirtualLightMemory virtual_light_memory() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lightcull
