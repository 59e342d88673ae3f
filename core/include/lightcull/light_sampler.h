#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/light.h>
#include <lightcull/span.h>

#include <cassert>
#include <cstdint>
#include <memory>
#include <vector>

namespace lightcull {

/// The glossy part of what a surface does with light: its BSDF times cosine is taken as
/// peak / (1 + s^2 (1 / alpha^2 - 1))^2, with s the sine of the angle between the normal and the
/// half vector h, of the light's direction and the view that `axis` mirrors. With alpha the
/// roughness of a GGX surface, this is its D(h). In a volume, where there is no normal, it is a
/// lobe about `axis`, with s the sine of half the angle to it, about. peak is then F D(n) / 4, over
/// the cosine of the view to the normal where that is above 0, with D(n) = 1 / (pi alpha^2) and F
/// the luminance of Fresnel's reflectance; `diffuse` is albedo / pi.
struct GlossyLobe {
    float3 axis{0, 0, 1};  ///< mirror direction of the view, unit length
    float alpha = 1.0f;    ///< (0, 1]
    float peak = 0.0f;     ///< value at the axis, in units of ShadingPoint::diffuse, >= 0; 0: there
                           ///< is no glossy part
};

/// A point to be lit.
struct ShadingPoint {
    float3 position;        ///< metres
    float3 normal;          ///< normal of unit length, on the side that receives light; 0 in a
                            ///< volume or where light from both sides counts
    std::uint32_t set = 0;  ///< set of random ranges to use, < LightSelector::set_count(); sets.h
                            ///< says which
    float diffuse = 1.0f;   ///< diffuse albedo / pi, in any unit, >= 0; a little of it guards a
                            ///< sampler from a lobe that is wrong
    GlossyLobe lobe{};      ///< glossy lobe of a surface that has one
};

/// What a path carries from select() to prob(): an account of all that could have been selected at
/// a point, for multiple importance sampling. It does not depend on u, and it is valid where
/// Selection::prob is 0. When a ray that left the point hits a light, the receipt that prob() needs
/// is that of the point which the ray left, not of the hit. Its numbers mean something to the
/// sampler alone, and in the pass of the selection: one pass is not enough for prob(), either.
struct Receipt {
    float weight_sum = 0.0f;  ///< W, the sum of the weights of the lights that were accepted
    std::uint32_t key = 0;    ///< the set that was used, or with bit 31 what else the sampler has
                              ///< chosen from
};

/// The light chosen for a point.
struct Selection {
    std::uint32_t light = 0;  ///< index into the caller's lights
    float prob = 0.0f;        ///< probability of the light, to divide its contribution by; in
                              ///< (0, 1], or 0 where no light was chosen, which is no error: the
                              ///< contribution is 0
    float mis_prob = 0.0f;    ///< what prob() says of the light, for MIS weights; equal to `prob`,
                              ///< but for samplers whose prob is not known for other lights
    Receipt receipt;
};

/// What became of a light that was selected for a point: what a sampler may learn from.
struct LightOutcome {
    float3 position;          ///< ShadingPoint::position of the point
    float3 normal;            ///< ShadingPoint::normal of the point
    Receipt receipt;          ///< Selection::receipt
    std::uint32_t light = 0;  ///< Selection::light
    float visibility = 0.0f;  ///< share of the light's rays that arrived, [0, 1]: 0 where a shadow
                              ///< ray was blocked, 1 or a transmittance where not
};

/// Chooses lights for shading points by random ranges that do not change: a pass of a LightSampler.
///
/// One pass is not enough. A selection is unbiased over passes, not within one: for the ranges of a
/// single pass and set, the mean over u alone is off (by a third at some points). Sums converge
/// over passes, or over the sets of a pass that has many (see sets.h).
///
/// Threads: all calls are const and may run on any number of threads at once. The hot calls check
/// nothing (make_checked_sampler() does): positions must be finite, normals of unit length or 0,
/// sets below set_count(), u in [0, 1).
class LIGHTCULL_EXPORT LightSelector {
  public:
    virtual ~LightSelector() = default;

    /// Chooses a light for a point by the random number u. It uses u up: take fresh numbers for the
    /// vertex on the light, and for all else.
    virtual Selection select(const ShadingPoint& point, float u) const noexcept = 0;

    /// Chooses a light for each of many points: selections[i] = select(points[i], u[i]), to the
    /// bit. The spans are of equal length, at most 2^32 - 1. A call is faster per point the more
    /// points there are, up to a whole image. It runs in the caller's TBB arena, isolated: while
    /// one of its threads waits for others it takes on none of the caller's tasks. It needs some 20
    /// bytes of memory a point, and throws Error where it does not get them, before anything is
    /// written.
    virtual void select(Span<const ShadingPoint> points, Span<const float> u,
                        Span<Selection> selections) const;

    /// The probability of `light` at a point whose receipt is at hand, for MIS weights. For a light
    /// that was not accepted the probability is what it would have been, had it been accepted: that
    /// makes weights of light and BSDF sampling sum to one in the mean ([TH16] leaves this open; 0
    /// or the W of the others would be biased). So for one receipt the probabilities of all lights
    /// need not sum to 1. The probability is that of the light as a whole: the density of a vertex
    /// on it, by area or solid angle, is the caller's to multiply with. The probability of the
    /// light that was selected is Selection::mis_prob.
    virtual float prob(const ShadingPoint& point, const Receipt& receipt,
                       std::uint32_t light) const noexcept = 0;

    /// False if prob() does not look at the receipt, which need not be kept then.
    virtual bool needs_receipt() const noexcept { return true; }

    /// prob() without a receipt. It may be called only where needs_receipt() is false.
    float prob(const ShadingPoint& point, std::uint32_t light) const noexcept {
        assert(!needs_receipt());
        return prob(point, Receipt{}, light);
    }

    /// Reports what became of selected lights, to a sampler that learns; others do not listen.
    /// It may be called from any thread and in any order, with any part of the selections of this
    /// pass, and does not change what the pass selects: what was learned is used from the next
    /// LightSampler::begin_pass() on, for which all outcomes count that have been reported by then.
    /// Outcomes that make no sense are left out. A host reports the shadow rays that it traced,
    /// and no others.
    virtual void report(Span<const LightOutcome> outcomes) const noexcept;

    /// False if report() need not be called: the sampler does not learn, or not from this pass.
    virtual bool wants_reports() const noexcept { return false; }

    /// False if no selection of this pass can have had this receipt.
    virtual bool knows(const Receipt& receipt) const noexcept { return receipt.key < set_count(); }

    /// Number of sets of random ranges, a power of 4. 1: it does not matter which a point uses.
    virtual std::uint32_t set_count() const noexcept { return 1; }
};

/// What LightSampler::update() did.
struct LightUpdate {
    bool rebuilt = false;  ///< the tree was built anew
    float growth = 1.0f;   ///< looseness of the tree before that, relative to when it was last
                           ///< built: 1 is as tight
};

/// Picks, for a shading point, one light out of many, and says with what probability it did.
/// One pass is not enough, as LightSelector says.
/// A host that renders whole images calls begin_pass() before each sample per pixel, and selects
/// from the sampler. A host that finishes a tile before the next takes a pass() for each tile,
/// thread or frame, any number at once, which begin_pass() leaves alone. A host whose samples are
/// spread over many sets (set_of_sample()) may stay with a single pass.
///
/// Threads: const calls may run on any number of threads at once; begin_pass() and update() only
/// while none of them runs.
class LIGHTCULL_EXPORT LightSampler : public LightSelector {
  public:
    /// Draws the random ranges of a pass, from which the sampler itself selects; equal numbers give
    /// equal ranges. Call it before the first selection and then once a pass. It takes some 10 ns
    /// per set and range, of which `culled` has one for each group of lights. Runs in the caller's
    /// TBB arena.
    virtual void begin_pass(std::uint64_t pass) = 0;

    /// The ranges that begin_pass(number) would draw, as an object of its own: it shares the tree
    /// with the sampler, never changes, and may outlive it. It takes the time of begin_pass() and
    /// some 5 bytes per set and group of lights. Runs in the caller's TBB arena.
    virtual std::unique_ptr<const LightSelector> pass(std::uint64_t number) const = 0;

    /// Takes lights that have moved, changed or been switched: as many as the sampler was made
    /// over, in the same order. Begin a pass after it; passes that were taken before stay what they
    /// are. `culled` and `light_bvh` keep the topology of their tree and fit it to the lights, in a
    /// tenth of the time that building takes. The tree is built anew if it has grown looser than
    /// `max_growth`, or a light shines that had no intensity when it was built; the other samplers
    /// always build anew. Ranges stay as long, in metres and for the same intensity, as they were
    /// calibrated. What `learned` knows counts for little from then on, since what hides lights may
    /// have moved, too, and it learns anew; where the tree is built anew, it forgets it. Runs in
    /// the caller's TBB arena. Throws Error, and changes nothing, for another number of lights, for
    /// lights that make_sampler() would refuse, and where the update cannot be done; a sampler of a
    /// host's own does that unless it overrides this.
    virtual LightUpdate update(Span<const Light> lights, float max_growth = 2.0f);

    /// Forgets what has been reported since the last begin_pass(), as a host does that drops a
    /// pass under way.
    virtual void drop_reports() noexcept {}

    /// What has been learned and reported since the sampler was made, as bytes; none if the sampler
    /// does not learn. Not while report() runs.
    virtual std::vector<std::uint8_t> learned() const { return {}; }

    /// Goes on, to the bit, as a sampler would of which these bytes are learned(): one over the
    /// same lights, made with the same options by the same version of lightcull. Begin a pass after
    /// it. Throws Error, and changes nothing, for bytes of another version or over other lights, or
    /// that make no sense, and for any if the sampler does not learn.
    virtual void restore_learned(Span<const std::uint8_t> bytes);
};

}  // namespace lightcull
