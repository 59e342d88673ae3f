#include <lightcull/triangle_cuts.h>

#include "base/memory_size.h"
#include "lights/parts/triangle_cutter.h"

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

constexpr float kBelow1 = 0x1.fffffep-1f;

bool is_even(const TriangleCuts::Piece& piece) noexcept {
    return piece.weights[0] == piece.weights[1] && piece.weights[1] == piece.weights[2];
}

}  // namespace

TriangleCuts::TriangleCuts(Span<const TriangleCorners> triangles, const CutDemand& demand) {
    TriangleCutter cutter(triangles, demand);
    cutter.cut_by_emission();
    cutter.cut_by_distance();
    cutter.finish(*this);
}

TriangleCuts::Piece TriangleCuts::draw(std::uint32_t part, double u) const noexcept {
    Piece piece{part, 1.0f, parts_[part].corners, {}};
    const Node* node = &nodes_[parts_[part].node];
    while (node->first_child != 0) {
        const auto share = static_cast<double>(node->share);
        const bool second = u >= share;
        const float prob = second ? 1.0f - node->share : node->share;
        constexpr double kBelowOne = 1.0 - 0x1p-53;
        u = std::min((second ? u - share : u) / static_cast<double>(prob), kBelowOne);
        piece.prob *= prob;
        piece.corners = half_of(piece.corners, node->edge, second);
        node = &nodes_[node->first_child + (second ? 1 : 0)];
    }
    std::copy_n(node->weights, 3, piece.weights);
    return piece;
}

TriangleCuts::Found TriangleCuts::at(std::uint32_t triangle, float2 place) const noexcept {
    float weights[3] = {1.0f - place.x - place.y, place.x, place.y};
    const Node* node = &nodes_[triangle];
    Piece piece{node->part, 1.0f, {}, {}};
    while (node->first_child != 0) {
        const std::uint32_t edge = node->edge, next = next_corner(edge);
        const bool second = weights[edge] < weights[next];
        if (piece.part != kNoPart) piece.prob *= second ? 1.0f - node->share : node->share;
        const std::uint32_t nearer = second ? next : edge, farther = second ? edge : next;
        weights[nearer] -= weights[farther];
        weights[farther] *= 2.0f;
        piece.corners = half_of(piece.corners, edge, second);
        node = &nodes_[node->first_child + (second ? 1 : 0)];
        if (piece.part == kNoPart) piece.part = node->part;
    }
    std::copy_n(node->weights, 3, piece.weights);
    return {piece, {weights[1], weights[2]}};
}

float2 TriangleCuts::draw_place(const Piece& piece, float u, float v) noexcept {
    if (is_even(piece)) {
        const float root = std::sqrt(u);
        return {root * (1.0f - v), root * v};
    }
    // A linear density is a mixture of three, each in proportion to the coordinate of one corner:
    // the distributions of Dirichlet with the parameters 2, 1, 1, of which the 2 has beta's with 2
    // and 2.
    std::uint32_t corner = 0;
    for (; corner < 2 && u >= piece.weights[corner]; ++corner) u -= piece.weights[corner];
    u = std::min(u / piece.weights[corner], kBelow1);
    const float own = 0.5f - std::sin(std::asin(1.0f - 2.0f * u) / 3.0f);
    float coordinates[3];
    coordinates[corner] = own;
    coordinates[next_corner(corner)] = (1.0f - own) * (1.0f - v);
    coordinates[next_corner(next_corner(corner))] = (1.0f - own) * v;
    return {coordinates[1], coordinates[2]};
}

float TriangleCuts::density(const Piece& piece, float2 place) noexcept {
    if (is_even(piece)) return 1.0f;
    const float* const w = piece.weights;
    return 3.0f * (w[0] * (1.0f - place.x - place.y) + w[1] * place.x + w[2] * place.y);
}

std::size_t TriangleCuts::memory_size() const noexcept {
    return size_of(nodes_) + size_of(parts_);
}

}  // namespace lightcull
