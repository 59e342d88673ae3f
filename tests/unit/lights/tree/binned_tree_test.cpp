#include <doctest/doctest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "base/random.h"
#include "lights/tree/binned_tree.h"

using namespace lightcull;

namespace {

/// A heuristic for points of a plane: the cost is a box's half perimeter times the number of points
/// in it.
template <std::uint32_t kDepth>
struct PointHeuristic {
    struct Item {
        std::uint32_t light;
        std::array<float, 2> place;
        float at(std::size_t dimension) const noexcept { return place[dimension]; }
    };
    struct Node : BinaryNode {
        std::uint32_t opened = 0, closed = 0;  ///< numbers of items
    };
    struct Extent {
        std::array<float, 2> low{1e30f, 1e30f}, high{-1e30f, -1e30f};
        std::uint32_t count = 0;
        void add(const Extent& other) noexcept {
            for (std::size_t d = 0; d < 2; ++d) {
                low[d] = std::min(low[d], other.low[d]);
                high[d] = std::max(high[d], other.high[d]);
            }
            count += other.count;
        }
    };
    struct Scale {};
    using Cost = double;
    static constexpr std::size_t kDimensions = 2;
    static constexpr std::uint32_t kMaxDepth = kDepth;
    static constexpr std::uint32_t kHalvedCount = 1;

    static std::uint32_t bin_count(std::uint32_t) noexcept { return 16; }
    Extent extent(const Item& item) const noexcept { return {item.place, item.place, 1}; }
    Scale scale(Span<const Item>) const noexcept { return {}; }
    double cost(const Extent& extent, Scale) const noexcept {
        const double x = static_cast<double>(extent.high[0]) - static_cast<double>(extent.low[0]);
        const double y = static_cast<double>(extent.high[1]) - static_cast<double>(extent.low[1]);
        return (x + y) * static_cast<double>(extent.count);
    }
    double weight(std::size_t, Scale) const noexcept { return 1.0; }
    void open(Node& node, Span<const Item> items) const noexcept {
        node.opened = node.closed = static_cast<std::uint32_t>(items.size());
    }
    void close(Node& node, const Node& left, const Node& right) const noexcept {
        node.closed = left.closed + right.closed;
    }
};

using Heuristic = PointHeuristic<64>;
using Item = Heuristic::Item;

template <typename AnyHeuristic>
std::vector<typename AnyHeuristic::Node> build(const std::vector<std::array<float, 2>>& places) {
    std::vector<typename AnyHeuristic::Item> items;
    for (const auto& place : places) {
        items.push_back({static_cast<std::uint32_t>(items.size()), place});
    }
    return BinnedTree<AnyHeuristic>::build(AnyHeuristic{}, std::move(items));
}

std::vector<std::array<float, 2>> random_places(std::uint32_t count, std::uint64_t seed) {
    RandomStream random(seed);
    std::vector<std::array<float, 2>> places(count);
    for (auto& place : places) place = {random.next(), 3.0f * random.next()};
    return places;
}

/// Places at distances that shrink by half: a split takes few off the far end, again and again.
std::vector<std::array<float, 2>> shrinking_places() {
    std::vector<std::array<float, 2>> places;
    for (int i = 0; i < 120; ++i) places.push_back({std::ldexp(1.0f, -i), 0.0f});
    return places;
}

/// The lights below a node, and the greatest depth in nodes; checks links and calls on the way.
template <typename Node>
std::uint32_t gather(const std::vector<Node>& nodes, std::uint32_t node,
                     std::vector<std::uint32_t>& lights) {
    REQUIRE(node < nodes.size());
    const std::size_t before = lights.size();
    std::uint32_t depth = 1;
    if (nodes[node].is_leaf()) {
        lights.push_back(nodes[node].light);
    } else {
        const std::uint32_t left = gather(nodes, node + 1, lights);
        REQUIRE(nodes[node].right == node + 2 * (lights.size() - before));
        depth += std::max(left, gather(nodes, nodes[node].right, lights));
    }
    CHECK(nodes[node].opened == lights.size() - before);
    CHECK(nodes[node].closed == nodes[node].opened);
    return depth;
}

template <typename Node>
std::uint32_t check_whole(const std::vector<Node>& nodes, std::size_t count) {
    REQUIRE(nodes.size() == 2 * count - 1);
    std::vector<std::uint32_t> lights, all(count);
    const std::uint32_t depth = gather(nodes, 0, lights);
    std::sort(lights.begin(), lights.end());
    std::iota(all.begin(), all.end(), 0u);
    CHECK(lights == all);
    return depth;
}

double cost_of(const std::vector<std::array<float, 2>>& places,
               const std::vector<std::uint32_t>& lights) {
    Heuristic::Extent all;
    for (const std::uint32_t i : lights) all.add(Heuristic{}.extent({i, places[i]}));
    return Heuristic{}.cost(all, {});
}

/// The least cost of a split between 16 bins, from the items themselves.
double least_cost_of_split(const std::vector<std::array<float, 2>>& places) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t d = 0; d < 2; ++d) {
        const auto by_place = [d](const auto& a, const auto& b) { return a[d] < b[d]; };
        const auto [low, high] = std::minmax_element(places.begin(), places.end(), by_place);
        const float inv_width = 16.0f / ((*high)[d] - (*low)[d]);
        for (int last = 0; last < 15; ++last) {
            std::vector<std::uint32_t> first, second;
            for (std::uint32_t i = 0; i < places.size(); ++i) {
                const float place = (places[i][d] - (*low)[d]) * inv_width;
                (place < static_cast<float>(last + 1) ? first : second).push_back(i);
            }
            if (first.empty() || second.empty()) continue;
            least = std::min(least, cost_of(places, first) + cost_of(places, second));
        }
    }
    return least;
}

}  // namespace

TEST_CASE("binned tree: every item has a leaf, in depth-first order") {
    CHECK(build<Heuristic>({}).empty());
    for (const std::uint32_t count : {1u, 2u, 3u, 9u, 100u, 5000u}) {
        check_whole(build<Heuristic>(random_places(count, count)), count);
    }
}

TEST_CASE("binned tree: a set is split where both parts cost least, by brute force") {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const auto places = random_places(2 + static_cast<std::uint32_t>(seed), seed);
        const auto nodes = build<Heuristic>(places);
        std::vector<std::uint32_t> left, right;
        gather(nodes, 1, left);
        gather(nodes, nodes[0].right, right);
        CHECK(cost_of(places, left) + cost_of(places, right) == least_cost_of_split(places));
    }
}

TEST_CASE("binned tree: items that nothing tells apart are halved") {
    const std::vector<std::array<float, 2>> places(1000, {1.0f, 2.0f});
    CHECK(check_whole(build<Heuristic>(places), 1000) == 11);
    // The width of such places has no inverse, or is itself too large for a float.
    const std::vector<std::array<float, 2>> close{{0.0f, 0.0f}, {1e-45f, 0.0f}};
    const std::vector<std::array<float, 2>> far{{-3e38f, 0.0f}, {3e38f, 0.0f}};
    check_whole(build<Heuristic>(close), 2);
    check_whole(build<Heuristic>(far), 2);
}

TEST_CASE("binned tree: none is too deep") {
    const auto places = shrinking_places();
    const auto depth = [&](const auto& nodes) { return check_whole(nodes, places.size()); };
    CHECK(depth(build<PointHeuristic<200>>(places)) > 26);  // left alone
    // The depth is that of the levels split by cost, and then of as many as 120 items that are
    // halved take at most.
    CHECK(depth(build<PointHeuristic<32>>(places)) == 8);
    CHECK(depth(build<PointHeuristic<40>>(places)) <= 8 + 8);
}

TEST_CASE("binned tree: it is the same for one thread and many") {
    const auto places = random_places(50000, 3);
    std::vector<Heuristic::Node> one;
    tbb::task_arena(1).execute([&] { one = build<Heuristic>(places); });
    const auto many = build<Heuristic>(places);
    const auto same = [](const Heuristic::Node& a, const Heuristic::Node& b) {
        return a.right == b.right && a.light == b.light;
    };
    CHECK(std::equal(one.begin(), one.end(), many.begin(), many.end(), same));
}
