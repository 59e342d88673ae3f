#include "lights/glossy/influence_tree.h"

#include <utility>

#include "base/memory_size.h"
#include "base/parallel_blocks.h"
#include "lights/ranges/sphere_tree_place.h"
#include "lights/tree/enclosing_sphere.h"

namespace lightcull {
namespace {

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

void InfluenceTree::place(std::uint32_t set) {
    SphereTree& tree = of_set_[set];
    float* const radii = radii_.data() + set * tree.slot_count();
    const auto volume = [&](std::uint32_t record) -> EnclosingSphere {
        const DirectedLight& light = shared_->lights[record];
        const Ball ball = light.volume(range(record, set));
        const float away = length(ball.center - light.center());
        return {ball.center, ball.radius, (away + light.radius()) * kSphereRoundUp};
    };
    const auto keep_radii = [&](std::size_t node, Span<const EnclosingSphere> slots,
                                const EnclosingSphere&) {
        float* const of_node = radii + node * SphereNode::kWidth;
        for (std::size_t i = 0; i < slots.size(); ++i) of_node[i] = slots[i].radius;
    };
    place_slots(tree.nodes, kSphereRoundUp, volume, keep_radii);
}

std::size_t InfluenceTree::memory_size() const noexcept {
    std::size_t size = size_of(shared_->order) + size_of(shared_->lights) + size_of(radii_);
    for (const SphereTree& tree : of_set_) size += tree.memory_size();
    return size;
}

}  // namespace lightcull
