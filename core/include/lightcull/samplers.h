#pragma once

#include <lightcull/export.h>
#include <lightcull/light.h>
#include <lightcull/light_sampler.h>
#include <lightcull/span.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

/// The samplers, each by its options. A light of intensity 0 is never chosen; with no light at all
/// select() answers prob 0.

namespace lightcull {

/// Chooses every light alike.
struct UniformOptions {};

/// Chooses in proportion to intensity, by an alias table.
struct PowerOptions {};

/// Chooses in proportion to the importance of every light at the point: the floor for error, at a
/// cost linear in the number of lights.
struct ExhaustiveOptions {};

/// The formula for the importance of a cluster of lights at a point.
enum class ClusterImportance {
    kBounds,  ///< the formula of Conty Estevez & Kulla 2018: intensity / d^2 times the cosines of
              ///< emitter and receiver, both angles reduced by the angle that the cluster's
              ///< bounding sphere fills; d is the distance to its centre, at least half its radius
    kMeans,   ///< our own formula: means of distance and cosines over the cluster; less variance
};

/// Importance sampling down a tree of light clusters, 8 children to a node (Conty Estevez & Kulla
/// 2018; without the adaptive splitting: one selection is one light).
struct LightBvhOptions {
    ClusterImportance importance = ClusterImportance::kBounds;
};

/// The lengths of the ranges of `culled`, `paper` and `clamped`.
struct RangeOptions {
    /// epsilon_max of [TH16] Eq. 7, > 0; none: found so that `expected_accepted` lights are
    /// accepted per point in the mean over SamplerContext::calibration_points.
    std::optional<float> error_bound;
    /// Lights, or groups of them, to accept per point, > 0. `culled` accepts all where there are no
    /// more than four times as many.
    float expected_accepted = 16.0f;
    /// E of [TH16] Eq. 7, > 0; used with a given error_bound only.
    float exposure = 1.0f;

    static RangeOptions with_error_bound(float error_bound) {
        RangeOptions options;
        options.error_bound = error_bound;
        return options;
    }
    static RangeOptions with_expected_accepted(float count) {
        RangeOptions options;
        options.expected_accepted = count;
        return options;
    }
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
    /// Number of sets, a power of 4, at most kMaxSetCount. None: what suits
    /// SamplerContext::points_per_pass, and where that is not known, 4096 as far as 64 MiB of
    /// memory allow, so that a host that never begins a second pass converges. With glossy points
    /// among the lights, whose sets take more memory, at most 16.
    std::optional<std::uint32_t> set_count;
    /// Most lights in a group, >= 1; 1 is the paper, and all there is with glossy points. None: a
    /// 400th of the lights, at most 128; 1 where lights that emit only within 60 degrees of their
    /// axis give more than a quarter of all intensity.
    std::optional<std::uint32_t> group_size;
};

inline constexpr std::uint32_t kMaxSetCount = 4096;

/// `culled`, and what it learns of visibility from the shadow rays that a host reports
/// (LightSelector::report). Space is divided into cells; each weighs up to 128 clusters of lights,
/// the more of them where it may be lit from, by importance and by the root of the share of shadow
/// rays to them that arrived. It is `culled` where no cell has been made and for a host that never
/// reports; also where there are no more than four lights, and where, when it is made, lights that
/// emit only within 26 degrees of their axis give more than a quarter of all intensity. Passes are
/// independent of one another once learning has come to rest. Glossy points must not be among the
/// lights.
struct LearnedOptions {
    std::uint32_t rounds = 96;  ///< passes begun after reports, until learning comes to rest; > 0
    std::uint32_t memory_mib = 64;  ///< most memory of all cells, MiB, > 0
};

/// Stochastic light culling as [TH16] has it, each choice a switch, so that the gain of each
/// departure can be shown.
struct PaperOptions {
    RangeOptions range = RangeOptions::with_error_bound(0.125f);
    std::uint32_t set_count = 1;  ///< number of sets, a power of 4, at most kMaxSetCount
    /// Section 5.2: the range is tested at the vertex that is sampled on the chosen light, by the
    /// host (see VertexCulling). False: at the light's bounding sphere.
    bool range_at_vertex = true;
    bool weight_by_g = true;       ///< an accepted light is weighed by g, Eq. 8; false: by g / p
    std::uint32_t list_size = 32;  ///< k of Alg. 3, 1 to 64; 0: there is no list, every accepted
                                   ///< light is weighed
};

/// Constant ranges ([TH16] appendix A): biased, for comparison.
struct ClampedOptions {
    RangeOptions range;
};

/// A sampler, named by the type of its options.
using SamplerSpec = std::variant<CulledOptions, LearnedOptions, LightBvhOptions, UniformOptions,
                                 PowerOptions, ExhaustiveOptions, ClampedOptions, PaperOptions>;

/// A sampler by its description: a name, then options, as in "culled", "culled:sets=16",
/// "paper:list=0:error_bound=auto", "clamped:error_bound=0.05". Names: uniform, power, light_bvh,
/// exhaustive, clamped, culled, learned, paper. Options: error_bound (a number or auto), accepted,
/// exposure (culled, paper, clamped); sets (culled, paper); group (culled); rounds, memory
/// (learned); test (vertex | light), weight (g | g_over_p), list (paper); importance (bounds |
/// means; light_bvh). Throws Error for an unknown name or option, with the names there are, and for
/// a value that make_sampler() would refuse.
LIGHTCULL_EXPORT SamplerSpec parse_sampler(std::string_view description);

/// Throws Error, with a message that names the option, if an option makes no sense. Every function
/// that makes a sampler does this first.
LIGHTCULL_EXPORT void check_sampler(const SamplerSpec& spec);

/// The use that a sampler is put to.
struct SamplerContext {
    /// Some hundred shading points typical of the scene, on which ranges are calibrated; none:
    /// points drawn from the bounds of the lights. They are read while the sampler is made.
    Span<const ShadingPoint> calibration_points;
    /// The number of pixels, for a host that begins a pass for each sample of the image. 0: not
    /// known.
    std::uint32_t points_per_pass = 0;
};

/// Makes a sampler over `lights`, of which it copies what it needs. Runs in the caller's TBB
/// arena. Throws Error with a message that names the light and the field, or the option.
LIGHTCULL_EXPORT std::unique_ptr<LightSampler> make_sampler(const SamplerSpec& spec,
                                                            Span<const Light> lights,
                                                            const SamplerContext& context = {});

/// The same as make_sampler(parse_sampler(description), lights, context).
LIGHTCULL_EXPORT std::unique_ptr<LightSampler> make_sampler(std::string_view description,
                                                            Span<const Light> lights,
                                                            const SamplerContext& context = {});

/// The part of `paper` that a host has to do beyond LightSelector, for its test at the vertex
/// ([TH16] section 5.2). A host that leaves it out is biased: it takes `paper:test=light`.
class LIGHTCULL_EXPORT VertexCulling {
  public:
    /// The factor of Eq. 10 that depends on the vertex sampled on the light that was selected, or 0
    /// if it is out of range. Multiply Selection::prob by it, and skip the light where it is 0.
    virtual float vertex_prob(const ShadingPoint& point, const Receipt& receipt,
                              std::uint32_t light, const float3& vertex) const noexcept = 0;

  protected:
    ~VertexCulling() = default;
};

/// The VertexCulling of a sampler or a pass which decides at the vertex; null for all others.
LIGHTCULL_EXPORT const VertexCulling* vertex_culling(const LightSelector& sampler) noexcept;

}  // namespace lightcull
