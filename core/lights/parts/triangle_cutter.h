#pragma once

#include <lightcull/triangle_cuts.h>

#include <cstddef>
#include <cstdint>
#include <queue>
#include <vector>

namespace lightcull {

/// Builds the trees of TriangleCuts: first down to pieces of even emission, then it finds the nodes
/// that are lights, or cuts on where even pieces are still too long.
class TriangleCutter {
  public:
    TriangleCutter(Span<const TriangleCorners> triangles, const CutDemand& demand);

    void cut_by_emission();
    void cut_by_distance();
    void finish(TriangleCuts& cuts) const;

  private:
    struct Draft {
        std::uint32_t triangle;
        SubTriangle corners;
        double area;
        PartEmission emission;
        double flux = 0.0;  ///< flux / pi, W: area * mean emission
        std::uint32_t first_child = 0;
        std::uint32_t edge = 0;
        bool is_part = false;
    };
    struct Candidate {
        double worth;
        std::uint32_t node;

        bool operator<(const Candidate& other) const noexcept {
            return worth != other.worth ? worth < other.worth : node > other.node;
        }
    };
    using Queue = std::priority_queue<Candidate>;

    void add_node(std::uint32_t triangle, const SubTriangle& corners, double area,
                  const PartEmission* even);
    bool can_split(const Draft& draft) const noexcept;
    void split(std::uint32_t node);
    void sum_flux();
    double longest_edge(const Draft& draft, std::uint32_t* edge) const noexcept;
    std::uint32_t lit_part_of(std::uint32_t node) const noexcept;
    /// Queues a node that is too long, and makes a part of any other.
    void consider(std::uint32_t node, Queue& queue);
    void number(std::uint32_t node, TriangleCuts& cuts) const;

    Span<const TriangleCorners> triangles_;
    const CutDemand& demand_;
    std::vector<Draft> nodes_;
};

}  // namespace lightcull
