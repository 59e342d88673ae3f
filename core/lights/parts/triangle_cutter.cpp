#include "lights/parts/triangle_cutter.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// The variance of the emission within pieces that is left, as a part of all light that the
/// triangles emit, for each piece.
constexpr double kLeastUnevenness = 1e-8;

/// The unevenness that counts as none: less is rounding, or not worth a cut.
constexpr float kEven = 1e-4f;

/// The longest edge of a light beside its distance to what it lights. Found by trial on strips,
/// ceilings and panels.
constexpr double kLongest = 1.0;

/// The same where the emission varies by as much as its mean: the middle of such a light may be far
/// from where it shines, and places on it are not chosen by solid angle.
constexpr double kLongestUneven = 0.25;

double longest_of(const PartEmission& emission) noexcept {
    const double variation = std::min(static_cast<double>(emission.unevenness), 1.0);
    return kLongest + (kLongestUneven - kLongest) * variation;
}

/// Nodes with less than this part of what their triangle emits are cut no more: an edge that
/// touches what it lights would be cut for ever.
constexpr double kLeastFlux = 1.0 / 256.0;

/// The edges of a node that can be cut, in barycentric coordinates: floats hold all places that
/// bisection makes of longer ones.
constexpr float kLeastEdge = 0x1p-20f;

struct Vector {
    double x, y, z;

    double length() const noexcept { return std::sqrt(x * x + y * y + z * z); }
};

Vector between(float3 a, float3 b) noexcept {
    return {static_cast<double>(b.x) - static_cast<double>(a.x),
            static_cast<double>(b.y) - static_cast<double>(a.y),
            static_cast<double>(b.z) - static_cast<double>(a.z)};
}

double area_of(const TriangleCorners& t) noexcept {
    const Vector p = between(t.a, t.b), q = between(t.a, t.c);
    const Vector normal{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
    return 0.5 * normal.length();
}

}  // namespace

TriangleCutter::TriangleCutter(Span<const TriangleCorners> triangles, const CutDemand& demand)
    : triangles_(triangles), demand_(demand) {
    nodes_.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        add_node(static_cast<std::uint32_t>(i), SubTriangle{}, area_of(triangles[i]), nullptr);
    }
}

/// even: what is emitted, where the parent emits the same all over.
void TriangleCutter::add_node(std::uint32_t triangle, const SubTriangle& corners, double area,
                              const PartEmission* even) {
    PartEmission emission = even != nullptr ? *even : demand_.emission(triangle, corners);
    if (!(emission.unevenness > kEven)) emission.unevenness = 0.0f;
    const double flux = area * static_cast<double>(emission.mean);
    nodes_.push_back({triangle, corners, area, emission, flux});
}

double TriangleCutter::longest_edge(const Draft& draft, std::uint32_t* edge) const noexcept {
    const TriangleCorners& t = triangles_[draft.triangle];
    const Vector ab = between(t.a, t.b), ac = between(t.a, t.c);
    double longest = -1.0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const float2 from = draft.corners.corners[i];
        const float2 to = draft.corners.corners[next_corner(i)];
        const double s = static_cast<double>(to.x - from.x), r = static_cast<double>(to.y - from.y);
        const double length =
            Vector{ab.x * s + ac.x * r, ab.y * s + ac.y * r, ab.z * s + ac.z * r}.length();
        if (length <= longest) continue;
        longest = length;
        *edge = i;
    }
    return longest;
}

bool TriangleCutter::can_split(const Draft& draft) const noexcept {
    std::uint32_t edge = 0;
    if (!(longest_edge(draft, &edge) > 0.0)) return false;
    const float2 from = draft.corners.corners[edge];
    const float2 to = draft.corners.corners[next_corner(edge)];
    return std::max(std::fabs(to.x - from.x), std::fabs(to.y - from.y)) > kLeastEdge;
}

void TriangleCutter::split(std::uint32_t node) {
    longest_edge(nodes_[node], &nodes_[node].edge);
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    for (const bool second : {false, true}) {
        const Draft parent = nodes_[node];
        const bool is_even = parent.emission.unevenness == 0.0f;
        add_node(parent.triangle, half_of(parent.corners, parent.edge, second), 0.5 * parent.area,
                 is_even ? &parent.emission : nullptr);
    }
    nodes_[node].first_child = first;
}

void TriangleCutter::cut_by_emission() {
    Queue queue;
    const auto consider_node = [&](std::uint32_t node, double least) {
        const Draft& draft = nodes_[node];
        const double worth = draft.flux * static_cast<double>(draft.emission.unevenness);
        if (!(worth > least && can_split(draft))) return false;
        queue.push({worth, node});
        return true;
    };
    double uneven = 0.0;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        if (consider_node(i, demand_.least_flux)) uneven += nodes_[i].flux;
    }
    const double least = kLeastUnevenness * uneven;
    for (std::size_t pieces = 0; pieces < demand_.most_pieces && !queue.empty(); ++pieces) {
        const std::uint32_t node = queue.top().node;
        queue.pop();
        split(node);
        consider_node(nodes_[node].first_child, least);
        consider_node(nodes_[node].first_child + 1, least);
    }
    sum_flux();
}

/// Makes the flux of nodes that of their leaves.
void TriangleCutter::sum_flux() {
    for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
        if (node->first_child == 0) continue;
        node->flux = nodes_[node->first_child].flux + nodes_[node->first_child + 1].flux;
    }
}

/// The smallest node that emits all that a node does.
std::uint32_t TriangleCutter::lit_part_of(std::uint32_t node) const noexcept {
    while (nodes_[node].first_child != 0) {
        const std::uint32_t first = nodes_[node].first_child;
        if (!(nodes_[first].flux > 0.0)) {
            node = first + 1;
        } else if (!(nodes_[first + 1].flux > 0.0)) {
            node = first;
        } else {
            break;
        }
    }
    return node;
}

void TriangleCutter::consider(std::uint32_t node, Queue& queue) {
    Draft& draft = nodes_[node];
    std::uint32_t edge = 0;
    const double least = std::max(demand_.least_flux, kLeastFlux * nodes_[draft.triangle].flux);
    if (demand_.distance && draft.flux > least && can_split(draft)) {
        const double longest = longest_edge(draft, &edge);
        const auto distance = static_cast<double>(demand_.distance(draft.triangle, draft.corners));
        const double ratio = longest / (longest_of(draft.emission) * distance);
        if (ratio > 1.0) {
            constexpr double kMostRatio = 4.0;
            queue.push({draft.flux * std::min(ratio, kMostRatio), node});
            return;
        }
    }
    draft.is_part = true;
}

void TriangleCutter::cut_by_distance() {
    Queue queue;
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
        if (nodes_[i].flux > 0.0) {
            consider(lit_part_of(i), queue);
        } else {
            nodes_[i].is_part = true;
        }
    }
    std::size_t added = 0;
    while (!queue.empty()) {
        const std::uint32_t node = queue.top().node;
        queue.pop();
        if (added == demand_.most_lights) {
            nodes_[node].is_part = true;
            continue;
        }
        if (nodes_[node].first_child == 0) split(node);
        std::size_t lit = 0;
        for (std::uint32_t child = nodes_[node].first_child, i = 0; i < 2; ++i) {
            if (!(nodes_[child + i].flux > 0.0)) continue;
            consider(lit_part_of(child + i), queue);
            ++lit;
        }
        if (lit == 0) nodes_[node].is_part = true;
        if (lit == 2) ++added;
    }
}

void TriangleCutter::number(std::uint32_t node, TriangleCuts& cuts) const {
    const Draft& draft = nodes_[node];
    if (draft.is_part) {
        cuts.nodes_[node].part = static_cast<std::uint32_t>(cuts.parts_.size());
        const bool is_whole = draft.first_child == 0;
        const float radiance =
            is_whole ? draft.emission.mean : static_cast<float>(draft.flux / draft.area);
        cuts.parts_.push_back({draft.triangle, node, radiance, draft.corners});
        return;
    }
    if (draft.first_child == 0) return;
    number(draft.first_child, cuts);
    number(draft.first_child + 1, cuts);
}

void TriangleCutter::finish(TriangleCuts& cuts) const {
    cuts.nodes_.reserve(nodes_.size());
    for (const Draft& draft : nodes_) {
        TriangleCuts::Node node;
        node.first_child = draft.first_child;
        node.edge = draft.edge;
        if (draft.first_child != 0) {
            const double first = nodes_[draft.first_child].flux;
            const double both = first + nodes_[draft.first_child + 1].flux;
            node.share = both > 0.0 ? static_cast<float>(first / both) : 0.5f;
        }
        const auto& densities = draft.emission.densities;
        const float sum = densities[0] + densities[1] + densities[2];
        for (int i = 0; i < 3; ++i) node.weights[i] = densities[i] / sum;
        cuts.nodes_.push_back(node);
    }
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) number(i, cuts);
}

}  // namespace lightcull
