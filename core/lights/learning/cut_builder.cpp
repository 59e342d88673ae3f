#include "lights/learning/cut_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/float3_math.h"
#include "base/random.h"
#include "base/reversed_bits.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/learning/light_rows.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = LightBvhNode::kWidth;

/// A cluster that is in the cut so far.
struct Candidate {
    LightBvhSlot slot;
    std::uint32_t child;
    Evidence evidence;
    float weight;
    float gain;  ///< what is gained by cutting it up
};

/// What is known of the clusters of a cut and of all above them, by slot.
class KnownEvidence {
  public:
    KnownEvidence(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                  const CutEvidence& evidence) {
        for (std::uint32_t i = 0; i < cut.size; ++i) {
            const Evidence& known = evidence.of[i];
            for (LightBvhSlot slot = cut.slot[i]; slot != LightBvh<MeansNode>::kNoSlot;
                 slot = bvh.parents[slot / kWidth]) {
                Evidence& sum = entry_of(slot);
                sum.tries += known.tries;
                sum.hits += known.hits;
            }
        }
    }

    /// What is known of a slot; below the cut, what the slot above hands down to a part of it that
    /// has a share of its rays.
    Evidence of(LightBvhSlot slot, const Evidence& above, float share) const {
        constexpr float kRays = 6.0f;
        const Entry& entry = slots_[place_of(slot)];
        return entry.slot == slot ? entry.sum : handed_down(above, share, kRays);
    }

  private:
    struct Entry {
        LightBvhSlot slot = LightBvh<MeansNode>::kNoSlot;
        Evidence sum;
    };

    /// The place of a slot's entry; if it has none, that of an empty one for it.
    std::size_t place_of(LightBvhSlot slot) const {
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = static_cast<std::size_t>(mix(slot)) & mask;
        while (slots_[at].slot != slot && slots_[at].slot != LightBvh<MeansNode>::kNoSlot) {
            at = (at + 1) & mask;
        }
        return at;
    }

    Evidence& entry_of(LightBvhSlot slot) {
        const std::size_t at = place_of(slot);
        if (slots_[at].slot == slot) return slots_[at].sum;
        if (2 * ++count_ > slots_.size()) {
            grow();
            return entry_of(slot);
        }
        slots_[at].slot = slot;
        return slots_[at].sum;
    }

    void grow() {
        std::vector<Entry> before(2 * slots_.size());
        before.swap(slots_);
        count_ = 0;
        for (const Entry& entry : before) {
            if (entry.slot != LightBvh<MeansNode>::kNoSlot) entry_of(entry.slot) = entry.sum;
        }
    }

    std::vector<Entry> slots_ = std::vector<Entry>(1024);  ///< a power of 2
    std::size_t count_ = 0;
};

bool is_light(std::uint32_t child) noexcept {
    return (child & LightBvhNode::kLight) != 0;
}

/// The node with clusters that reach a place where they reach any point of it.
MeansNode reaching(const MeansNode& node, float radius) noexcept {
    MeansNode wide = node;
    for (std::size_t i = 0; i < kWidth; ++i) {
        wide.radius[i] += radius;
        wide.apex[i] += 2.0f * radius;
    }
    return wide;
}

/// The node with clusters that are as wide as if all points of the place were seen from one.
MeansNode softened(const MeansNode& node, float radius) noexcept {
    MeansNode soft = reaching(node, radius);
    for (std::size_t i = 0; i < kWidth; ++i) {
        soft.spread[i] = std::copysign(std::abs(soft.spread[i]) + radius * radius, 1.0f);
    }
    return soft;
}

float3 center_of(const MeansNode& node, std::size_t i) noexcept {
    return {node.center[0][i], node.center[1][i], node.center[2][i]};
}

/// What the clusters of a tree give a place, by their importance.
class GivenToPlace {
  public:
    GivenToPlace(const LightBvh<MeansNode>& bvh, const CutPlace& place)
        : bvh_(bvh),
          radius_(place.radius),
          receiver_(place.position, place.normal),
          in_volume_(place.position, {0, 0, 0}) {}

    /// The importances of the children of a node.
    LightBvhImportances by_child(std::uint32_t n) const noexcept {
        const MeansNode& node = bvh_.nodes[n];
        LightBvhImportances g;
        light_bvh_kernels<MeansNode>().importances(softened(node, radius_), receiver_, g.of);
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            if (node.child[i] == LightBvhNode::kEmpty) g.of[i] = 0.0f;
        }
        return g;
    }

    /// The importance of a cluster as the sum over its parts, `depth` nodes further down. own: what
    /// it is by the cluster itself.
    float by_parts(std::uint32_t child, float own, int depth) const noexcept {
        if (depth == 0 || is_light(child)) return own;
        const LightBvhImportances g = by_child(child);
        float sum = 0.0f;
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            if (g.of[i] > 0.0f) sum += by_parts(bvh_.nodes[child].child[i], g.of[i], depth - 1);
        }
        return sum;
    }

    /// The importance of a child of a node, whatever the receiver's normal, in units of what
    /// far clusters are multiplied by at a receiver (CutKernels::weigh).
    float by_cosine(std::uint32_t n, std::uint32_t child) const noexcept {
        const MeansNode& node = bvh_.nodes[n];
        LightBvhImportances g;
        light_bvh_kernels<MeansNode>().importances(reaching(node, radius_), in_volume_, g.of);
        const float3 way = center_of(node, child) - in_volume_.position;
        const float spread = std::abs(node.spread[child]);
        const float all_sides = in_volume_.from_all_sides * (dot(way, way) + spread);
        return g.of[child] / std::sqrt(spread + all_sides);
    }

  private:
    const LightBvh<MeansNode>& bvh_;
    float radius_;
    Receiver receiver_;
    Receiver in_volume_;
};

/// True if the distance of a child of a node, and its emission towards a place, vary little over
/// it.
bool is_far(const MeansNode& node, std::size_t i, const CutPlace& place) noexcept {
    // So many radii away from it, and in front of what emits by a cosine. Measured.
    constexpr float kFar = 12.0f;
    const float least = kFar * place.radius;
    const float3 way = center_of(node, i) - place.position;
    const float distance2 = dot(way, way);
    if (!(distance2 > least * least)) return false;
    const float3 normal{node.mean_normal[0][i], node.mean_normal[1][i], node.mean_normal[2][i]};
    const float along = dot(normal, way);
    const float facing = std::signbit(node.diffuse[i]) ? std::abs(along) : -along;
    const float mean_distance2 = distance2 + std::abs(node.spread[i]);
    const float root = std::sqrt(facing * facing + std::max(node.spread[i], 0.0f) +
                                 std::abs(node.diffuse[i]) * mean_distance2);
    return facing + root > 2.0f * least * length(normal);
}

/// Calls visit(place) for the places from `begin` to `end`, run by run. `begin` begins a block.
template <typename Visit>
void for_each_place(std::uint32_t begin, std::uint32_t end, const Visit& visit) {
    for (std::uint32_t column = 0; column < ClusterCut::kBlock; ++column) {
        for (std::uint32_t at = begin + column; at < end; at += ClusterCut::kBlock) visit(at);
    }
}

/// Puts the runs of a cut in order, by the clusters of their first places.
void order_runs(ClusterCut& cut) noexcept {
    constexpr std::uint32_t kRuns = CutWeights::kRuns, kBits = 5;
    static_assert(kRuns == 1u << kBits);
    std::array<std::pair<std::uint32_t, std::uint8_t>, kRuns> order;
    for (std::uint8_t run = 0; run < kRuns; ++run) {
        const std::uint32_t place =
            run < ClusterCut::kBlock ? run : cut.near_size + run - ClusterCut::kBlock;
        order[run] = {place < cut.size ? cut.cluster_at[place] : ClusterCut::kMaxSize, run};
    }
    std::sort(order.begin(), order.end());
    // Sums of halves are gone through in the order of reversed bits.
    for (std::uint32_t i = 0; i < kRuns; ++i)
        cut.run[reversed_bits(i) >> (32 - kBits)] = order[i].second;
}

/// Gives each cluster of a cut its place: near ones first, with those next to the cell where they
/// do not fill their blocks. The clusters of a run are next to each other in the order of the
/// tree's leaves. Sets far_scale as it is where `scale` is 1.
void find_places(const LightBvh<MeansNode>& bvh, const CutPlace& place, const GivenToPlace& given,
                 ClusterCut& cut) noexcept {
    float by_cosine[ClusterCut::kMaxSize];  // of clusters that may be far; 0: others
    std::array<std::pair<float, std::uint8_t>, ClusterCut::kMaxSize> order;
    std::uint32_t near = 0;
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const std::uint32_t n = cut.slot[i] / kWidth, child = cut.slot[i] % kWidth;
        const MeansNode& node = bvh.nodes[n];
        // What a single light gives is known exactly.
        const bool may_be = !is_light(node.child[child]) && is_far(node, child, place);
        by_cosine[i] = may_be ? given.by_cosine(n, child) : 0.0f;
        const bool far = by_cosine[i] > 0.0f;
        near += far ? 0 : 1;
        const float3 way = center_of(node, child) - place.position;
        order[i] = {far ? dot(way, way) : 0.0f, static_cast<std::uint8_t>(i)};
    }
    std::sort(order.begin(), order.begin() + cut.size);
    constexpr std::uint32_t kBlock = ClusterCut::kBlock;
    cut.near_size = (near + kBlock - 1) / kBlock * kBlock;
    const std::uint32_t first_far = std::min(cut.near_size, cut.size);
    std::uint8_t next = 0;
    const auto in_order = [](const auto& a, const auto& b) { return a.second < b.second; };
    std::sort(order.begin(), order.begin() + first_far, in_order);
    std::sort(order.begin() + first_far, order.begin() + cut.size, in_order);
    const auto place_next = [&](std::uint32_t at) {
        const std::uint8_t cluster = order[next++].second;
        cut.cluster_at[at] = cluster;
        cut.place_of[cluster] = static_cast<std::uint8_t>(at);
        cut.far_scale[at] = at < cut.near_size ? 0.0f : by_cosine[cluster];
    };
    for_each_place(0, first_far, place_next);
    for_each_place(first_far, cut.size, place_next);
    order_runs(cut);
}

class CutBuilder {
  public:
    CutBuilder(const LightBvh<MeansNode>& bvh, const CutPlace& place, const KnownEvidence& known)
        : bvh_(bvh), place_(place), given_(bvh, place), known_(known) {
        clusters_.reserve(ClusterCut::kMaxSize);
        if (!bvh.nodes.empty()) open(0, {});
    }

    /// Cuts up what gains most by it, as far as there is room: all, where that are the lights.
    void refine(std::uint32_t lights) {
        if (lights <= ClusterCut::kMaxSize) return open_all();
        while (true) {
            const auto best = std::max_element(
                clusters_.begin(), clusters_.end(),
                [](const Candidate& a, const Candidate& b) { return a.gain < b.gain; });
            if (best == clusters_.end() || !(best->gain > kLeastGain * weight_sum_)) return;
            if (clusters_.size() + kWidth - 1 > ClusterCut::kMaxSize) return;
            open(static_cast<std::size_t>(best - clusters_.begin()));
        }
    }

    std::vector<Candidate>& clusters() noexcept { return clusters_; }

  private:
    /// What a cluster's size counts for beside what it may hide, found by trial on the example
    /// scenes.
    static constexpr float kSizeCounts = 4.0f;
    /// The share of all weight below which a gain is not worth a cluster.
    static constexpr float kLeastGain = 1e-3f;

    void open_all() {
        for (std::size_t i = 0; i < clusters_.size();) {
            if (is_light(clusters_[i].child)) {
                ++i;
            } else {
                open(i);
            }
        }
    }

    /// Puts the children of a cluster in its place.
    void open(std::size_t i) {
        const Candidate opened = clusters_[i];
        clusters_[i] = clusters_.back();
        clusters_.pop_back();
        weight_sum_ -= opened.weight;
        open(opened.child, opened.evidence);
    }

    void open(std::uint32_t n, const Evidence& above) {
        const MeansNode& node = bvh_.nodes[n];
        const LightBvhImportances g = given_.by_child(n);
        float g_sum = 0.0f;
        for (const float weight : g.of) g_sum += weight;
        for (std::uint32_t i = 0; i < kWidth; ++i) {
            if (node.child[i] == LightBvhNode::kEmpty) continue;
            const LightBvhSlot slot = n * kWidth + i;
            const Evidence evidence = known_.of(slot, above, g_sum > 0 ? g.of[i] / g_sum : 0.0f);
            const float factor = visible_factor(evidence), weight = g.of[i] * factor;
            weight_sum_ += weight;
            const float gain = is_light(node.child[i])
                                   ? 0.0f
                                   : weight * (1.0f - factor +
                                               kSizeCounts * (relative_size(node, i) +
                                                              misjudged(node.child[i], g.of[i])));
            clusters_.push_back({slot, node.child[i], evidence, weight, gain});
        }
    }

    /// The square of how much the importance of a node as a whole is off, relative to it, as far as
    /// those of its children tell: what that adds to the variance, relative to the weight.
    float misjudged(std::uint32_t n, float weight) const noexcept {
        if (!(weight > 0.0f)) return 0.0f;
        const float off = given_.by_parts(n, weight, 1) / weight - 1.0f;
        return off * off;
    }

    /// The relative variance of what a cluster's lights give the place, about.
    float relative_size(const MeansNode& node, std::size_t i) const noexcept {
        const float3 way = center_of(node, i) - place_.position;
        const float spread = std::abs(node.spread[i]);
        return spread / (dot(way, way) + spread + place_.radius * place_.radius);
    }

    const LightBvh<MeansNode>& bvh_;
    const CutPlace& place_;
    GivenToPlace given_;
    const KnownEvidence& known_;
    std::vector<Candidate> clusters_;
    float weight_sum_ = 0.0f;
};

}  // namespace

Evidence handed_down(const Evidence& evidence, float share, float rays) noexcept {
    const float hidden = std::max(0.0f, evidence.tries - 8.0f * evidence.hits);
    return evidence.at_most(std::max(rays, share * hidden));
}

float visible_factor(const Evidence& evidence) noexcept {
    // Rays that arrived, as a part of one, before the first was traced.
    constexpr float kPrior = 0.1f;
    if (!(evidence.tries > 0.0f)) return 1.0f;
    const float visible = (evidence.hits + kPrior) / (evidence.tries + kPrior);
    return std::clamp(std::sqrt(visible), kLeastVisible, kMostVisible);
}

Evidence evidence_of(float visible_factor, float tries) noexcept {
    if (visible_factor > kMostVisible) return {};
    return {tries, tries * visible_factor * visible_factor};
}

void rebuild_cut(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves, const CutPlace& place,
                 ClusterCut& cut, CutEvidence& evidence) {
    const KnownEvidence known(bvh, cut, evidence);
    CutBuilder builder(bvh, place, known);
    builder.refine(leaves.size());
    std::vector<Candidate>& clusters = builder.clusters();
    std::sort(clusters.begin(), clusters.end(), [&](const Candidate& a, const Candidate& b) {
        return leaves.first(a.slot) < leaves.first(b.slot);
    });
    cut.clear();
    for (const Candidate& cluster : clusters) {
        const std::uint32_t i = cut.size++;
        cut.first_leaf[i] = leaves.first(cluster.slot);
        cut.slot[i] = cluster.slot;
        cut.visible[i] = visible_factor(cluster.evidence);
        evidence.of[i] = cluster.evidence;
    }
    refresh_cut(bvh, leaves, place, cut);
}

void refresh_cut(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves, const CutPlace& place,
                 ClusterCut& cut) noexcept {
    // Two nodes further down is about as good as all of them.
    constexpr int kDepth = 2;
    constexpr float kLeast = 0.25f, kMost = 4.0f;
    const GivenToPlace given(bvh, place);
    find_places(bvh, place, given, cut);
    for (std::uint32_t i = 0; i < cut.size; ++i) {
        const std::uint32_t n = cut.slot[i] / kWidth, child = cut.slot[i] % kWidth;
        const std::uint32_t at = cut.place_of[i];
        cut.set(at, bvh.nodes[n], child);
        const float own = is_light(cut.child[at]) ? 0.0f : given.by_child(n).of[child];
        const float judged = own > 0.0f ? given.by_parts(cut.child[at], own, kDepth) / own : 1.0f;
        cut.scale[at] = cut.visible[i] * std::clamp(judged, kLeast, kMost);
        cut.far_scale[at] *= cut.scale[at];
    }
    const bool may_be = cut.size < leaves.size() && leaves.size() <= LightRows::kMost;
    cut.by_light = may_be && gains_by_each_light(bvh, leaves.size(), place, cut);
}

}  // namespace lightcull
