#pragma once

#include <lightcull/light.h>
#include <lightcull/light_sampler.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

/// The samplers. Each make_ function copies what it needs of `lights`, checks it, and throws
/// lightcull::Error with a message that names the light and the field. A light of intensity 0 is
/// never chosen; with no light at all select() answers prob 0.

namespace lightcull {

/// Every light alike.
std::unique_ptr<LightSampler> make_uniform_sampler(Span<const Light> lights);

/// In proportion to intensity, by an alias table.
std::unique_ptr<LightSampler> make_power_sampler(Span<const Light> lights);

/// In proportion to the importance of every light at the point: the floor for error, at a cost
/// linear in the number of lights.
std::unique_ptr<LightSampler> make_exhaustive_sampler(Span<const Light> lights);

/// What a cluster of lights counts for at a point.
enum class ClusterImportance {
    kBounds,  ///< as Conty Estevez & Kulla 2018 have it: intensity / d^2 times the cosines of
              ///< emitter and receiver, both angles reduced by the angle that the cluster's
              ///< bounding sphere fills; d is to its centre, at least half its radius
    kMeans,   ///< ours: means of distance and cosines over the cluster; less variance
};

/// Importance sampling down a tree of light clusters, 8 children to a node (Conty Estevez & Kulla
/// 2018; without the adaptive splitting: one selection is one light).
struct LightBvhOptions {
    ClusterImportance importance = ClusterImportance::kBounds;
};
std::unique_ptr<LightSampler> make_light_bvh_sampler(Span<const Light> lights,
                                                     const LightBvhOptions& options = {});

/// How long the ranges of `culled`, `paper` and `clamped` are.
struct RangeOptions {
    /// epsilon_max of [TH16] Eq. 7; none: found so that `expected_accepted` lights are accepted
    /// per point in the mean over `calibration_points`.
    std::optional<float> error_bound;
    float expected_accepted = 16.0f;
    /// E of [TH16] Eq. 7; used with a given error_bound only.
    float exposure = 1.0f;
    /// Some hundred shading points typical of the scene; none: points drawn from the bounds of the
    /// lights.
    Span<const ShadingPoint> calibration_points;
};

/// Stochastic light culling: acceptance per light and not per vertex, resampling by g / p, no list,
/// rotated sets; and lights that lie together share a range as a group, of which one is then chosen
/// down a light BVH (ClusterImportance::kMeans). Measured on the example scenes, groups leave up to
/// a fifth more error than single lights with as many of them accepted, for a third to half of the
/// nodes.
///
/// Where any light is a glossy point, each light has a range of its own, and that of a glossy or
/// diffuse point depends on the direction ([TH17] Eqs. 2 to 5): it is accepted within a spheroid
/// with the light in one focus, or an egg above its surface.
struct CulledOptions {
    RangeOptions range;
    std::uint32_t set_count = 64;  ///< a power of 4, at most 4096
    /// Most lights in a group, >= 1; 1 is the paper, and all there is with glossy points. None: a
    /// 400th of them, at most 128.
    std::optional<std::uint32_t> group_size;
};
std::unique_ptr<LightSampler> make_culled_sampler(Span<const Light> lights,
                                                  const CulledOptions& options = {});

/// Stochastic light culling as [TH16] has it, each choice a switch, so that the gain of each
/// departure can be shown.
struct PaperOptions {
    RangeOptions range{0.125f, 16.0f, 1.0f, {}};
    std::uint32_t set_count = 1;
    bool range_at_vertex = true;   ///< section 5.2; false: at the light's bounding sphere
    bool weight_by_g = true;       ///< Eq. 8; false: by g / p
    std::uint32_t list_size = 32;  ///< k of Alg. 3, 1 to 64; 0: weigh every accepted light, no list
};
std::unique_ptr<LightSampler> make_paper_sampler(Span<const Light> lights,
                                                 const PaperOptions& options = {});

/// Constant ranges ([TH16] appendix A): biased, for comparison.
std::unique_ptr<LightSampler> make_clamped_sampler(Span<const Light> lights,
                                                   const RangeOptions& options = {});

/// What make_sampler() needs to know of the use a sampler is put to.
struct SamplerContext {
    Span<const ShadingPoint> calibration_points;  ///< as in RangeOptions
    std::uint32_t points_per_pass = 0;            ///< 0: not known
};

/// A sampler by its description: a name, then options, as in "culled", "culled:sets=16",
/// "paper:list=0:error_bound=auto", "clamped:error_bound=0.05". Names: uniform, power, light_bvh,
/// exhaustive, clamped, culled, paper. Options: error_bound (a number or auto), accepted, exposure
/// (culled, paper, clamped); sets (culled, paper); group (culled); test (vertex | light), weight (g
/// | g_over_p), list (paper); importance (bounds | means; light_bvh). Without `sets`, culled takes
/// as many as suit context.points_per_pass. Throws Error for an unknown name or option, with the
/// names there are.
std::unique_ptr<LightSampler> make_sampler(std::string_view description, Span<const Light> lights,
                                           const SamplerContext& context = {});

}  // namespace lightcull
