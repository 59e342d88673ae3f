#pragma once

#include <cassert>

#include "lights/ranges/range_kernels.h"
#include "lights/ranges/sphere_tree.h"

namespace lightcull {

/// The state of a traversal: nodes that are still to be read. The node found first is read next, so
/// that none waits for what was just computed; in a tree of more nodes than there is room for, it
/// is the node found last. Either way the order is the tree's: whatever else is visited, two leaves
/// are found in the same order.
class TreeWalk {
  public:
    static bool is_first_in_first_out(const SphereTree& tree) noexcept {
        return tree.nodes.size() <= kRoom;
    }

    explicit TreeWalk(const SphereTree& tree) noexcept
        : first_in_first_out_(is_first_in_first_out(tree)) {
        *new_nodes() = 0;
        if (!tree.empty()) add(1);
    }

    bool over() const noexcept { return begin_ == end_; }
    std::uint32_t take() noexcept {
        assert(!over());
        return nodes_[first_in_first_out_ ? begin_++ : --end_];
    }

    /// The place to write the nodes that are found, up to SphereNode::kWidth.
    std::uint32_t* new_nodes() noexcept { return nodes_ + end_; }
    /// Takes in the `count` nodes that were written.
    void add(std::uint32_t count) noexcept {
        end_ += count;
        assert(end_ <= kRoom);
    }

  private:
    /// Room for nodes: 64 KiB on the stack, of which little is touched; last in, first out takes
    /// twice the time.
    static constexpr std::uint32_t kRoom = 16384;
    /// In depth-first order, all but one of the children of each node on the way down may wait.
    static_assert(kRoom > SphereTree::kMaxDepth * (SphereNode::kWidth - 1));

    bool first_in_first_out_;
    std::uint32_t begin_ = 0, end_ = 0;
    std::uint32_t nodes_[kRoom + SphereNode::kWidth];
};

/// The records whose spheres hold the point, as many as find_leaves() found at a time.
struct FoundLeaves {
    static constexpr std::uint32_t kCapacity = 64;

    std::uint32_t records[kCapacity];
    std::uint32_t count = 0;
    std::uint32_t nodes_visited = 0;  ///< nodes that all calls together have read

    Span<const std::uint32_t> all() const noexcept { return {records, count}; }
};

/// Calls visit(Span of records) for the leaves whose spheres hold the point and whose lights may be
/// above its horizon, some at a time. Returns the number of nodes read.
template <typename Visit>
std::uint32_t traverse(const SphereTree& tree, const float* radii, const Receiver& receiver,
                       Visit&& visit) noexcept {
    const auto find_leaves = range_kernels().find_leaves;
    TreeWalk walk(tree);
    FoundLeaves found;
    while (!walk.over()) {
        find_leaves(tree, radii, receiver, walk, found);
        visit(found.all());
    }
    return found.nodes_visited;
}

}  // namespace lightcull
