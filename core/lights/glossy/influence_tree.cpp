#include "lights/glossy/influence_tree.h"

#include <algorithm>
#include <utility>

#include "base/memory_size.h"
#include "base/parallel_blocks.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kWidth = SphereNode::kWidth;

/// More than the rounding of a sum and a distance.
constexpr float kRoundUp = 1.0f + 1e-6f;

/// A sphere around volumes, and one of the same centre around the lights alone.
struct Around {
    Ball ball{};
    float bounds = 0.0f;
};

Around around_light(const DirectedLight& light, float range) noexcept {
    const Ball ball = light.volume(range);
    return {ball, (length(ball.center - light.center()) + light.radius()) * kRoundUp};
}

/// About the middle of the box around spheres, of which there is one at least.
Around around_all(const Around* spheres, std::uint32_t count) noexcept {
    float3 low = spheres[0].ball.center, high = low;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Ball& ball = spheres[i].ball;
        const float3 r{ball.radius, ball.radius, ball.radius};
        low = min(low, ball.center - r);
        high = max(high, ball.center + r);
    }
    Around result{{low * 0.5f + high * 0.5f, 0.0f}, 0.0f};
    for (std::uint32_t i = 0; i < count; ++i) {
        const float away = length(spheres[i].ball.center - result.ball.center);
        result.ball.radius =
            std::max(result.ball.radius, (spheres[i].ball.radius + away) * kRoundUp);
        result.bounds = std::max(result.bounds, (spheres[i].bounds + away) * kRoundUp);
    }
    return result;
}

/// The volumes at their least range, as spheres that build_sphere_tree() knows.
SphereTree topology_of(const std::vector<DirectedLight>& lights, const RandomRanges& ranges) {
    std::vector<RangedLight> spheres;
    spheres.reserve(lights.size());
    for (const DirectedLight& light : lights) {
        const float range = ranges.range(light.intensity(), 1.0f);
        const Ball ball = light.volume(range);
        const float part = (ball.radius - light.radius()) / range;
        spheres.push_back({ball.center, light.radius(), light.intensity() * part * part});
    }
    return build_sphere_tree(spheres, ranges.reach());
}

}  // namespace

InfluenceTree::InfluenceTree(Span<const LightRecord> records, const RandomRanges& ranges)
    : ranges_(ranges) {
    const std::vector<DirectedLight> lights(records.begin(), records.end());
    SphereTree topology = topology_of(lights, ranges);
    Shared shared;
    shared.lights.reserve(lights.size());
    for (const std::uint32_t i : topology.order) shared.lights.push_back(lights[i]);
    of_set_.resize(ranges.set_count());
    for (SphereTree& tree : of_set_) tree.nodes = topology.nodes;
    radii_.resize(topology.slot_count() * ranges.set_count(), kNoRadius);
    shared.order = std::move(topology.order);
    shared_ = std::make_shared<const Shared>(std::move(shared));
}

InfluenceTree::InfluenceTree(const InfluenceTree& other, std::uint64_t pass)
    : ranges_(other.ranges_),
      shared_(other.shared_),
      of_set_(other.of_set_),
      radii_(other.radii_.size(), kNoRadius) {
    begin_pass(pass);
}

void InfluenceTree::begin_pass(std::uint64_t pass) {
    ranges_.begin_pass(pass);
    for_each_block(of_set_.size(), 1,
                   [&](std::size_t set, std::size_t) { place(static_cast<std::uint32_t>(set)); });
}

/// Bottom up.
void InfluenceTree::place(std::uint32_t set) {
    std::vector<SphereNode>& nodes = of_set_[set].nodes;
    float* const radii = radii_.data() + set * of_set_[set].slot_count();
    std::vector<Around> around(nodes.size());
    for (std::size_t n = nodes.size(); n-- > 0;) {
        SphereNode& node = nodes[n];
        Around slots[kWidth];
        std::uint32_t count = 0;
        for (; count < kWidth && node.link[count] != SphereNode::kEmpty; ++count) {
            const std::uint32_t link = node.link[count], record = link & ~SphereNode::kLeaf;
            slots[count] = (link & SphereNode::kLeaf) == 0
                               ? around[link]
                               : around_light(light(record), range(record, set));
            const Ball& ball = slots[count].ball;
            node.x[count] = ball.center.x;
            node.y[count] = ball.center.y;
            node.z[count] = ball.center.z;
            node.bounds[count] = slots[count].bounds;
            radii[n * kWidth + count] = ball.radius;
        }
        around[n] = around_all(slots, count);
    }
}

std::size_t InfluenceTree::memory_size() const noexcept {
    std::size_t size = size_of(shared_->order) + size_of(shared_->lights) + size_of(radii_);
    for (const SphereTree& tree : of_set_) size += tree.memory_size();
    return size;
}

}  // namespace lightcull
