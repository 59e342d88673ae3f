#include "wavefront/lane_selector.h"

namespace mitsuba::culling {

using ::lightcull::LightOutcome;
using ::lightcull::Selection;

LaneSelector::Chosen LaneSelector::choose(const Mask& wanted, const Point3f& position,
                                          const Receiver<Float>& receiver, const UInt32& path,
                                          const Float& random, std::uint32_t depth) {
    if (!has_choice()) {
        const Float certain(light_count_ == 1 ? 1.0f : 0.0f);
        return {UInt32(0), certain, certain};
    }
    const UInt32 left = dr::compress(wanted);
    const Column<std::uint32_t> lanes(left);
    const std::size_t count = dr::width(path);
    gather_points(lanes, position, receiver, path, random, depth);
    memory_.choices.selections.resize(lanes.size());
    sampler_.select(memory_.choices.points, memory_.random, memory_.choices.selections);
    spread(lanes, count);
    return {memory_.lights.view<UInt32>(), memory_.probs.view<Float>(),
            memory_.mis_probs.view<Float>()};
}

void LaneSelector::gather_points(const Column<std::uint32_t>& lanes, const Point3f& position,
                                 const Receiver<Float>& receiver, const UInt32& path,
                                 const Float& random, std::uint32_t depth) {
    const VectorColumn positions(position), normals(receiver.normal), axes(receiver.axis);
    const Column<float> diffuse(receiver.diffuse), alphas(receiver.alpha), peaks(receiver.peak);
    const Column<float> randoms(random);
    const Column<std::uint32_t> paths(path);
    LaneMemory::Choices& choices = memory_.choices;
    choices.slots.resize(dr::width(path));
    choices.points.resize(lanes.size());
    memory_.random.resize(lanes.size());
    for_each_lane(lanes.size(), [&](std::size_t k) {
        const std::uint32_t i = lanes[k];
        choices.slots[i] = static_cast<std::uint32_t>(k);
        choices.points[k] = {positions[i],
                             normals[i],
                             pattern_.sets(paths[i]).at(depth, sampler_.set_count()),
                             diffuse[i],
                             {axes[i], alphas[i], peaks[i]}};
        memory_.random[k] = randoms[i];
    });
}

void LaneSelector::spread(const Column<std::uint32_t>& lanes, std::size_t count) {
    memory_.lights.assign(count, 0);
    memory_.probs.assign(count, 0.0f);
    memory_.mis_probs.assign(count, 0.0f);
    for_each_lane(lanes.size(), [&](std::size_t k) {
        const std::uint32_t i = lanes[k];
        const Selection& chosen = memory_.choices.selections[k];
        memory_.lights[i] = chosen.light;
        memory_.probs[i] = chosen.prob;
        memory_.mis_probs[i] = chosen.mis_prob;
    });
}

LaneSelector::Float LaneSelector::hit_probs(const Mask& asks, const UInt32& light,
                                            const UInt32& origin) {
    if (!has_choice()) return 1.0f;
    const std::size_t count = dr::width(origin);
    memory_.hit_probs.assign(count, 1.0f);
    const Column<bool> asking(asks);
    const Column<std::uint32_t> lights(light), origins(origin);
    const LaneMemory::Choices& last = memory_.choices;
    for_each_lane(count, [&](std::size_t i) {
        if (!asking[i]) return;
        const std::uint32_t slot = last.slots[origins[i]];
        memory_.hit_probs[i] =
            sampler_.prob(last.points[slot], last.selections[slot].receipt, lights[i]);
    });
    return memory_.hit_probs.view<Float>();
}

LaneSelector::Float LaneSelector::vertex_probs(const ::lightcull::VertexCulling& culling,
                                               const Mask& asks, const Point3f& places) {
    const LaneMemory::Choices& last = memory_.choices;
    memory_.vertex_probs.assign(last.slots.size(), 1.0f);
    const Column<bool> asking(asks);
    const VectorColumn positions(places);
    for_each_lane(last.slots.size(), [&](std::size_t i) {
        if (!asking[i]) return;
        const std::uint32_t slot = last.slots[i];
        const Selection& selection = last.selections[slot];
        memory_.vertex_probs[i] = culling.vertex_prob(last.points[slot], selection.receipt,
                                                      selection.light, positions[i]);
    });
    return memory_.vertex_probs.view<Float>();
}

void LaneSelector::report(const Mask& traced, const Mask& arrived) const {
    const Column<bool> was_traced(traced), has_arrived(arrived);
    const LaneMemory::Choices& last = memory_.choices;
    for_each_lane(last.slots.size(), [&](std::size_t i) {
        if (!was_traced[i]) return;
        const std::uint32_t slot = last.slots[i];
        const ::lightcull::ShadingPoint& point = last.points[slot];
        const Selection& selection = last.selections[slot];
        const LightOutcome outcome{point.position, point.normal, selection.receipt, selection.light,
                                   has_arrived[i] ? 1.0f : 0.0f};
        sampler_.report({&outcome, 1});
    });
}

}  // namespace mitsuba::culling
