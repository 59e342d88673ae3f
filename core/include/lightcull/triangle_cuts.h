#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/light.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace lightcull {

struct TriangleCorners {
    float3 a, b, c;  ///< metres
};

/// A triangle inside another one. Its corners are places in that: barycentric coordinates of the
/// second and the third corner. By default it is all of it.
struct SubTriangle {
    float2 corners[3]{{0, 0}, {1, 0}, {0, 1}};
};

/// The corner after a corner, of the three that go round.
inline std::uint32_t next_corner(std::uint32_t corner) noexcept {
    return corner == 2 ? 0 : corner + 1;
}

/// One half of a triangle: the middle of the edge from `edge` to the next corner takes the place of
/// the next corner, or, in the second half, of this one. Halves of halves are exact as long as
/// floats hold the powers of 2.
inline SubTriangle half_of(const SubTriangle& whole, std::uint32_t edge, bool second) noexcept {
    const float2 a = whole.corners[edge], b = whole.corners[next_corner(edge)];
    SubTriangle half = whole;
    half.corners[second ? edge : next_corner(edge)] = {0.5f * (a.x + b.x), 0.5f * (a.y + b.y)};
    return half;
}

/// The part of the triangle's area that a sub-triangle has.
inline float area_share(const SubTriangle& part) noexcept {
    const float2 o = part.corners[0], p = part.corners[1], q = part.corners[2];
    return (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
}

/// The place in a triangle of a place in a sub-triangle of it, both barycentric.
inline float2 place_in(const SubTriangle& part, float2 place) noexcept {
    const float2 o = part.corners[0], p = part.corners[1], q = part.corners[2];
    return {o.x + (p.x - o.x) * place.x + (q.x - o.x) * place.y,
            o.y + (p.y - o.y) * place.x + (q.y - o.y) * place.y};
}

/// What a sub-triangle emits.
struct PartEmission {
    float mean = 0.0f;  ///< mean radiance, luminance; 0: nothing is emitted from it anywhere
    /// Places on a piece are drawn with a density that is linear between these numbers at its
    /// corners, of any unit, all above 0.
    float densities[3]{1.0f, 1.0f, 1.0f};
    /// Variance of the radiance over that density, places being drawn so, over mean^2; 0: none.
    float unevenness = 0.0f;
};

/// What asks for cuts, of the triangle of an index.
struct CutDemand {
    std::function<PartEmission(std::uint32_t, const SubTriangle&)> emission;
    /// The distance to what the sub-triangle lights, metres; infinity if it lights nothing. Without
    /// this function triangles are not cut into lights.
    std::function<float(std::uint32_t, const SubTriangle&)> distance;
    /// What emits less than this is not cut because of the distance, and triangles whose flux times
    /// unevenness is less, not because of the emission; flux / pi, W: area * mean radiance.
    double least_flux = 0.0;
    std::size_t most_lights = 4096;   ///< lights that cuts add at most
    std::size_t most_pieces = 32768;  ///< pieces of even emission that cuts add at most
};

/// What cuts are worth among the lights of a scene.
struct CutLimits {
    double least_flux = 0.0;      ///< CutDemand::least_flux
    std::size_t most_lights = 0;  ///< CutDemand::most_lights
};

/// The limits that suit a scene of these lights, of which any may be triangles to be cut. A light
/// is worth a cut if it emits at least a thousandth of what all do, but for the brightest, of which
/// some may be suns far away: among very many lights, none of them alone makes noise.
LIGHTCULL_EXPORT CutLimits cut_limits(Span<const Light> lights);

/// Cuts emissive triangles into parts, each a light of its own, where they are longer than their
/// distance to what they light; and each part, where its emission is uneven, into pieces, of which
/// one is drawn in proportion to what it emits, and then a place on it. Parts and pieces are the
/// nodes and the leaves of one binary tree per triangle, by bisection of longest edges. Where
/// nothing is emitted there are none.
class LIGHTCULL_EXPORT TriangleCuts {
  public:
    static constexpr std::uint32_t kNoPart = 0xffffffffu;

    struct Part {
        std::uint32_t triangle;
        std::uint32_t node;   ///< node of the tree
        float radiance;       ///< mean over its area, luminance
        SubTriangle corners;  ///< corners in the triangle
    };

    /// A piece of a part: all of it if its emission is even.
    struct Piece {
        std::uint32_t part;   ///< index of the part; kNoPart where nothing is emitted
        float prob;           ///< probability of the piece among those of the part
        SubTriangle corners;  ///< corners in the triangle
        float weights[3];     ///< densities at its corners, with a sum of 1
    };

    TriangleCuts() = default;
    /// The calls of `demand` end before this does.
    TriangleCuts(Span<const TriangleCorners> triangles, const CutDemand& demand);

    /// The lights: those of the first triangle, then of the next. Every triangle has some; one of
    /// radiance 0 if it emits nothing.
    Span<const Part> parts() const noexcept { return parts_; }
    /// False if all of the triangle is one part and one piece.
    bool is_cut(std::uint32_t triangle) const noexcept { return nodes_[triangle].first_child != 0; }

    /// Draws a piece of a part by `u` in [0, 1). It uses u up: take fresh numbers for the place. As
    /// there may be tens of thousands of pieces, 24 random bits are few.
    Piece draw(std::uint32_t part, double u) const noexcept;
    /// The piece in which a place of a triangle lies (at an edge, some piece next to it), and the
    /// barycentric coordinates that the place has in the piece.
    struct Found {
        Piece piece;
        float2 place;
    };
    Found at(std::uint32_t triangle, float2 place) const noexcept;

    /// Draws a place on a piece by u and v in [0, 1): barycentric coordinates in the piece.
    static float2 draw_place(const Piece& piece, float u, float v) noexcept;
    /// The density by area of a place on a piece that is drawn so, times the area of the piece.
    static float density(const Piece& piece, float2 place) noexcept;

    /// The memory that this takes, bytes.
    std::size_t memory_size() const noexcept;

    /// A node of a tree. Of the edge from one corner to the next the middle is a corner of both
    /// children: of the first in place of the next one, of the second in place of this one.
    struct Node {
        std::uint32_t first_child = 0;  ///< 0: none
        std::uint32_t part = kNoPart;   ///< the part that the node is, if it is one
        std::uint32_t edge = 0;         ///< the first corner of the edge that is bisected
        float share = 0.0f;             ///< the first child's share of what the node emits
        float weights[3]{};             ///< those of a piece
    };

    /// The nodes, for a host that walks the trees itself, as in a kernel of its own. The first ones
    /// are roots, one per triangle; the leaves at or below a part are its pieces.
    Span<const Node> nodes() const noexcept { return nodes_; }

  private:
    friend class TriangleCutter;

    std::vector<Node> nodes_;
    std::vector<Part> parts_;
};

}  // namespace lightcull
