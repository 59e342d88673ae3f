#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace lightcull {

/// Chooses which nodes of a binary tree become children of wide nodes, up to kWidth to each, so
/// that the costs of the wide nodes have the least sum that the binary tree allows: dynamic
/// programming over subtrees and numbers of children (Ylitie et al. 2017, "Efficient incoherent ray
/// traversal on GPUs through compressed wide BVHs").
///
/// Node: derived from BinaryNode. The binary tree must outlive this.
template <typename Node, std::size_t kWidth>
class WideTree {
  public:
    /// The binary nodes that become children, from left to right.
    class Children {
      public:
        const std::uint32_t* begin() const noexcept { return nodes_.data(); }
        const std::uint32_t* end() const noexcept { return nodes_.data() + size_; }
        std::uint32_t size() const noexcept { return size_; }
        std::uint32_t operator[](std::size_t i) const noexcept { return nodes_[i]; }

        void push_back(std::uint32_t node) noexcept { nodes_[size_++] = node; }

      private:
        std::array<std::uint32_t, kWidth> nodes_{};
        std::uint32_t size_ = 0;
    };

    /// Plans the wide tree. cost(node): cost of a wide node that stands for an inner node of the
    /// binary tree, a float.
    template <typename Cost>
    WideTree(const std::vector<Node>& binary, const Cost& cost)
        : binary_(binary), plans_(binary.size()) {
        // Children come after their parents.
        for (std::size_t i = binary.size(); i-- > 0;) {
            if (!binary[i].is_leaf()) plans_[i] = plan(i, cost(binary[i]));
        }
    }

    /// The binary nodes that become children of the wide node that stands for `node`; for a leaf,
    /// the leaf itself.
    Children children(std::uint32_t node) const noexcept {
        Children result;
        if (binary_[node].is_leaf()) {
            result.push_back(node);
            return result;
        }
        std::array<Part, kWidth> pending;  // the leftmost part is last
        std::size_t size = 0;
        const auto open = [&](std::uint32_t parent, std::size_t left, std::size_t count) {
            pending[size++] = {binary_[parent].right, count - left};
            pending[size++] = {parent + 1, left};
        };
        open(node, plans_[node].left_of_node, kWidth);
        while (size > 0) {
            const Part part = pending[--size];
            const std::size_t left = plans_[part.node].left[part.count - 1];
            if (left == 0) {
                result.push_back(part.node);
            } else {
                open(part.node, left, part.count);
            }
        }
        return result;
    }

  private:
    /// A plan of how a subtree is best spread over children of one wide node; all 0 for a leaf.
    struct Plan {
        std::array<float, kWidth> cost{};         ///< cost over at most k + 1 children: [k]
        std::array<std::uint8_t, kWidth> left{};  ///< number of those children that go to the left
                                                  ///< subtree: [k]; 0: the subtree becomes one
                                                  ///< child
        std::uint8_t left_of_node = 0;            ///< number of kWidth children of a node of its
                                                  ///< own that go to the left subtree
    };

    /// A subtree that is spread over `count` children.
    struct Part {
        std::uint32_t node;
        std::size_t count;
    };

    Plan plan(std::size_t node, float cost_of_node) const noexcept {
        const Plan &left = plans_[node + 1], &right = plans_[binary_[node].right];
        Plan plan;
        for (std::size_t k = 2; k <= kWidth; ++k) {
            float best = std::numeric_limits<float>::max();
            std::uint8_t best_left = 1;
            for (std::size_t j = 1; j < k; ++j) {
                const float cost = left.cost[j - 1] + right.cost[k - j - 1];
                if (cost < best) {
                    best = cost;
                    best_left = static_cast<std::uint8_t>(j);
                }
            }
            plan.cost[k - 1] = best;
            plan.left[k - 1] = best_left;
        }
        plan.left_of_node = plan.left[kWidth - 1];
        plan.cost[0] = plan.cost[kWidth - 1] + cost_of_node;
        for (std::size_t k = 2; k <= kWidth; ++k) {
            if (plan.cost[k - 1] < plan.cost[0]) continue;
            plan.cost[k - 1] = plan.cost[0];
            plan.left[k - 1] = 0;
        }
        return plan;
    }

    const std::vector<Node>& binary_;
    std::vector<Plan> plans_;
};

}  // namespace lightcull
