#pragma once

#include <lightcull/float3.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>

namespace lightcull {

/// The glossy part of what a surface does with light: its BSDF times cosine is taken as
/// peak / (1 + (1 - c) / (2 alpha^2))^2, with c the cosine between the light's direction and
/// `axis`. With alpha the roughness of a GGX surface, this is its D(h) in the plane of incidence.
struct GlossyLobe {
    float3 axis{0, 0, 1};  ///< unit length; mirror direction of the view
    float alpha = 1.0f;    ///< (0, 1]
    float peak = 0.0f;     ///< in units of ShadingPoint::diffuse, >= 0; 0: there is no such part. A
                           ///< host that also samples its BSDF (MIS) does best with a tenth of it
};

/// A point to be lit.
struct ShadingPoint {
    float3 position;        ///< metres
    float3 normal;          ///< unit length, on the side that receives light; 0 in a volume or
                            ///< where light from both sides counts
    std::uint32_t set = 0;  ///< set of random ranges to use, < LightSampler::set_count()
    float diffuse = 1.0f;   ///< diffuse albedo / pi, in any unit, >= 0; a little of it guards a
                            ///< sampler from a lobe that is wrong
    GlossyLobe lobe{};      ///< for surfaces that are glossy
};

/// What a path carries from select() to prob() for multiple importance sampling.
struct Receipt {
    float weight_sum = 0.0f;  ///< W: sum of the weights of all accepted lights; of `culled`
                              ///< negative where it is the weight of one alone
    std::uint32_t key = 0;    ///< the set that was used
};

/// The light chosen for a point.
struct Selection {
    std::uint32_t light = 0;  ///< index into the caller's lights
    float prob = 0.0f;        ///< divide the light's contribution by it; in (0, 1], or 0 where no
                              ///< light was chosen, which is no error: the contribution is 0
    Receipt receipt;
};

/// What one selection costs, counted by a second, slower run of it.
struct SelectionCounts {
    std::uint32_t nodes_visited = 0;  ///< tree nodes that were read
    std::uint32_t lights_tested = 0;  ///< lights whose range or importance was computed
    std::uint32_t accepted = 0;       ///< lights that were weighed with a weight above 0
};

/// Picks, for a shading point, one light out of many, and says with what probability it did.
///
/// Threads: const calls may run on any number of threads at once; begin_pass() only while none of
/// them runs. The hot calls check nothing: positions must be finite, normals of unit length or 0,
/// sets below set_count(), u in [0, 1).
class LightSampler {
  public:
    virtual ~LightSampler() = default;

    /// Draws the random ranges of a pass; equal numbers give equal ranges. Call it before the
    /// first selection and then once a pass. Runs in the caller's TBB arena.
    virtual void begin_pass(std::uint64_t pass) = 0;

    /// Chooses a light for a point by the random number u.
    virtual Selection select(const ShadingPoint& point, float u) const noexcept = 0;

    /// The same for many points: selections[i] = select(points[i], u[i]), to the bit. The spans
    /// are of equal length, at most 2^32 - 1. Faster the more points there are, up to a whole
    /// image; runs in the caller's TBB arena and needs some 20 bytes of memory a point.
    virtual void select(Span<const ShadingPoint> points, Span<const float> u,
                        Span<Selection> selections) const noexcept;

    /// The probability of `light` at a point whose receipt is at hand, for MIS weights. For a
    /// light that was not accepted it is what it would have been, had it been accepted: that makes
    /// weights of light and BSDF sampling sum to one in the mean. Equal to Selection::prob for the
    /// light that was selected, unless prob_is_proxy().
    virtual float prob(const ShadingPoint& point, const Receipt& receipt,
                       std::uint32_t light) const noexcept = 0;

    /// True if prob() is only a stand-in for Selection::prob, good for MIS weights if both
    /// techniques use it.
    virtual bool prob_is_proxy() const noexcept { return false; }

    /// For samplers that decide at the vertex sampled on the chosen light ([TH16] section 5.2):
    /// the factor of Eq. 10 that depends on it, or 0 if the vertex is out of range. Multiply
    /// Selection::prob by it, and skip the light where it is 0. Otherwise 1.
    virtual float vertex_prob(const ShadingPoint& point, const Receipt& receipt,
                              std::uint32_t light, const float3& vertex) const noexcept;

    /// Number of sets of random ranges in a pass.
    virtual std::uint32_t set_count() const noexcept { return 1; }

    /// The cost of select() at a point.
    virtual SelectionCounts count(const ShadingPoint& point) const noexcept = 0;

    /// What the sampler keeps in memory, bytes.
    virtual std::size_t memory_size() const noexcept = 0;
};

/// The set for camera points of pixel (x, y): its place in a square pattern of `set_count` pixels,
/// which neighbours never share. set_count is a power of 4.
std::uint32_t set_of_pixel(std::uint32_t x, std::uint32_t y, std::uint32_t set_count) noexcept;

/// The set for the points of packet `packet` (a few points that lie together) of later bounces.
std::uint32_t set_of_packet(std::uint32_t packet, std::uint32_t set_count) noexcept;

}  // namespace lightcull
