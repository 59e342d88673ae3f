#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/samplers.h>

#include <cstdint>
#include <vector>

#include "arrays/host_columns.h"
#include "arrays/variants.h"
#include "lanes/chosen_light.h"
#include "sampler/range_sets.h"
#include "scene/surface_receiver.h"

namespace mitsuba::culling {

/// What goes to and from a light sampler. It is kept from one bounce and pass to the next, since to
/// get as much memory from the system each time would cost more than to fill it.
struct LaneMemory {
    /// What was chosen at one bounce.
    struct Choices {
        std::vector<std::uint32_t> slots;  ///< of each lane that chose: where it is in the next two
        std::vector<::lightcull::ShadingPoint> points;
        std::vector<::lightcull::Selection> selections;
    };
    Choices choices;
    std::vector<float> random;  ///< for each of choices.points
    // These have an element for each lane.
    SharedArray<std::uint32_t> lights;
    SharedArray<float> hit_probs, probs, mis_probs, vertex_probs;
};

/// Chooses lights for whole wavefronts, on the processor, between their kernels.
class LaneSelector {
  public:
    using Float = LlvmFloat;
    using UInt32 = dr::uint32_array_t<Float>;
    using Mask = dr::mask_t<Float>;
    using Point3f = Point<Float, 3>;

    /// What it refers to is overwritten by the next choice.
    using Chosen = ChosenLight<Float>;

    LaneSelector(const ::lightcull::LightSampler& sampler, std::size_t light_count,
                 const SetPattern& pattern, LaneMemory& memory)
        : sampler_(sampler), light_count_(light_count), pattern_(pattern), memory_(memory) {}

    /// Whether there is a choice. If not, the arguments of the calls below need not be evaluated.
    bool has_choice() const { return light_count_ > 1; }

    /// Chooses a light for every lane of `wanted`. `path` names the path that is in each lane.
    Chosen choose(const Mask& wanted, const Point3f& position, const Receiver<Float>& receiver,
                  const UInt32& path, const Float& random, std::uint32_t depth);

    /// The probability with which `light` would have been chosen by the last choose(), in the lane
    /// `origin` of then; 1 for a lane that does not ask.
    Float hit_probs(const Mask& asks, const UInt32& light, const UInt32& origin);

    /// The parts of the probabilities of the last choose() that depend on the places sampled on the
    /// lights, in the lanes of `asks`; 1 in the others. Only where there is a VertexCulling.
    Float vertex_probs(const ::lightcull::VertexCulling& culling, const Mask& asks,
                       const Point3f& places);

    /// False if report() need not be called.
    bool wants_reports() const { return has_choice() && sampler_.wants_reports(); }

    /// Reports the shadow rays to the lights of the last choose(): the lanes that traced one, and
    /// those in which it arrived.
    void report(const Mask& traced, const Mask& arrived) const;

  private:
    void gather_points(const Column<std::uint32_t>& lanes, const Point3f& position,
                       const Receiver<Float>& receiver, const UInt32& path, const Float& random,
                       std::uint32_t depth);
    void spread(const Column<std::uint32_t>& lanes, std::size_t count);

    const ::lightcull::LightSampler& sampler_;
    std::size_t light_count_;
    SetPattern pattern_;
    LaneMemory& memory_;
};

}  // namespace mitsuba::culling
