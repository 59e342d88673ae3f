#pragma once

#include <lightcull/float3.h>

#include <cstdint>

#include "lights/bvh/light_bvh.h"
#include "lights/learning/cluster_cut.h"
#include "lights/learning/leaf_order.h"

namespace lightcull {

/// The points for which a cut is made, in the units of the lights.
struct CutPlace {
    float3 position;  ///< mean of their positions
    float3 normal;    ///< mean normal, unit length; 0: points of a volume, or of many normals
    float radius;     ///< distance that they keep from the mean, about
};

/// The shadow rays to a cluster that were traced, and those that arrived. A transmittance is part
/// of a ray; what is handed down to a part of a cluster counts for less.
struct Evidence {
    float tries = 0.0f, hits = 0.0f;

    /// The same share of hits, from no more than `rays` tries.
    Evidence at_most(float rays) const noexcept {
        return tries > rays ? Evidence{rays, hits * (rays / tries)} : *this;
    }
};

/// What is known of a whole says as much of a part of it as `rays` rays; where almost all is
/// hidden, as much as the rays that went there, a share of them.
Evidence handed_down(const Evidence& evidence, float share, float rays) noexcept;

/// The evidence of each cluster of a cut.
struct CutEvidence {
    Evidence of[ClusterCut::kMaxSize];
};

/// The factor by which a cluster's importance is multiplied, of V, the share of its shadow rays
/// that arrive: a root, since what varies is squared (Rath et al. 2020, "Variance-aware path
/// guiding": p in proportion to the root of the second moment). 1 before the first ray, and
/// afterwards at most kMostVisible.
float visible_factor(const Evidence& evidence) noexcept;

/// As many tries, or none, of which visible_factor() gives this, about.
Evidence evidence_of(float visible_factor, float tries) noexcept;

/// The least that visible_factor() returns: no light's probability is below that times what it
/// would be without learning.
inline constexpr float kLeastVisible = 0.02f;
/// Below 1, so that what has been seen is told from what has not been tried.
inline constexpr float kMostVisible = 0x1.fffffep-1f;

/// Makes the cut with the most detail where a place may be lit from and where it is not yet known
/// what of a cluster it sees, and hands over what is known of the clusters of `cut` before.
/// Writes both.
void rebuild_cut(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves, const CutPlace& place,
                 ClusterCut& cut, CutEvidence& evidence);

/// True if points of a place are better served by the weights of all lights than by a cut, whose
/// clusters are misjudged there: by the variance of a sample at some of them, and by the time that
/// so many lights take.
bool gains_by_each_light(const LightBvh<MeansNode>& bvh, std::uint32_t light_count,
                         const CutPlace& place, const ClusterCut& cut) noexcept;

/// Takes the quantities of clusters, and their scales, from a tree that has been refitted.
void refresh_cut(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves, const CutPlace& place,
                 ClusterCut& cut) noexcept;

}  // namespace lightcull
