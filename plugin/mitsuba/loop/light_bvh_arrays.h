#pragma once

#include <lightcull/light_bvh_table.h>

#include <drjit/array.h>
#include <drjit/dynamic.h>
#include <drjit/jit.h>
#include <drjit/while_loop.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lanes/chosen_light.h"
#include "loop/light_bvh_walk.h"
#include "scene/surface_receiver.h"

namespace mitsuba::culling {

namespace dr = drjit;

/// A light BVH as Dr.Jit arrays, which is walked within a kernel: the selection of
/// light_bvh:importance=means, by a symbolic loop of which each turn is a level of the tree.
template <typename Float_>
class LightBvhArrays {
  public:
    /// Nothing is derived through selection.
    using Float = dr::detached_t<Float_>;
    using Double = dr::float64_array_t<Float>;
    using UInt32 = dr::uint32_array_t<Float>;
    using Mask = dr::mask_t<Float>;
    using Position = mitsuba::Point<Float_, 3>;
    using WalkPoint = walk::Point<Float>;

    /// `has_lobes`: receivers may have a glossy lobe.
    LightBvhArrays(const ::lightcull::LightBvhTable& table, bool has_lobes)
        : nodes_(table.parents.size()), has_lobes_(has_lobes) {
        if (nodes_ == 0) return;
        // Lights that move must not need another kernel.
        origin_ = {dr::opaque<Float>(table.origin.x), dr::opaque<Float>(table.origin.y),
                   dr::opaque<Float>(table.origin.z)};
        inv_scale_ = dr::opaque<Float>(table.inv_scale);
        static_assert(sizeof(::lightcull::LightBvhCluster) == kWords * sizeof(float));
        if (nodes_ == 1) load_root(table);
        const std::size_t count = table.clusters.size();
        clusters_ = dr::load<Float>(table.clusters.data(), kWords * count);
        std::vector<std::uint32_t> children(count);
        for (std::size_t i = 0; i < count; ++i) children[i] = table.clusters[i].child;
        children_ = dr::load<UInt32>(children.data(), count);
        parents_ = dr::load<UInt32>(table.parents.data(), table.parents.size());
        leaves_ = dr::load<UInt32>(table.leaves.data(), table.leaves.size());
        dr::sync_thread();  // the vectors must live until they are copied
    }

    /// Chooses a light for each point by two numbers in [0, 1), of which the second gives digits
    /// that the first does not have.
    ChosenLight<Float_> choose(const Position& position, const Receiver<Float_>& receiver,
                               const Float_& random_1, const Float_& random_2,
                               const dr::mask_t<Float_>& active) const {
        if (nodes_ == 0) return {0u, 0.0f, 0.0f};
        const WalkPoint point = local(position, receiver);
        constexpr double kLastDigit = 0x1p-24;
        const Double place = dr::minimum(
            Double(dr::detach<false>(random_1)) + kLastDigit * Double(dr::detach<false>(random_2)),
            1.0 - kLastDigit);
        Descent descent{UInt32(0), place, Float(1.0f)};
        const Mask wanted = dr::detach<false>(active);
        if (nodes_ == 1) {
            walk::step_down<Types>(*this, point, wanted, descent);
        } else {
            dr::tie(descent.child, descent.place, descent.prob) = dr::while_loop(
                dr::make_tuple(descent.child, descent.place, descent.prob),
                [wanted](const UInt32& child, const Double&, const Float& prob) {
                    return wanted && (child & ::lightcull::LightBvhTable::kLight) == 0u &&
                           prob > 0.0f;
                },
                [this, point](UInt32& child, Double& place, Float& prob) {
                    Descent step{child, place, prob};
                    walk::step_down<Types>(*this, point, Mask(true), step);
                    child = step.child;
                    place = step.place;
                    prob = step.prob;
                },
                "lightcull: to a light");
        }
        const UInt32 light = descent.child & ~::lightcull::LightBvhTable::kLight;
        return {light, descent.prob, descent.prob};
    }

    /// The probability with which choose() finds `light` at each point.
    Float_ prob(const Position& position, const Receiver<Float_>& receiver,
                const dr::uint32_array_t<Float_>& light, const dr::mask_t<Float_>& active) const {
        if (nodes_ == 0) return 0.0f;
        const WalkPoint point = local(position, receiver);
        const Mask wanted = dr::detach<false>(active);
        UInt32 cluster = dr::gather<UInt32>(leaves_, dr::detach<false>(light), wanted);
        Float prob = dr::select(cluster == kNone, Float(0.0f), Float(1.0f));
        // Where no lane asks, nothing is computed: few rays hit lights.
        dr::tie(cluster, prob) = dr::while_loop(
            dr::make_tuple(cluster, prob),
            [wanted](const UInt32& cluster, const Float&) { return wanted && cluster != kNone; },
            [this, point](UInt32& cluster, Float& prob) {
                prob *= walk::prob_of_step<Types>(*this, point, cluster, Mask(true));
                cluster = dr::gather<UInt32>(parents_, cluster / kWidth, Mask(true));
            },
            "lightcull: from a light");
        return prob;
    }

    // For walk::step_down() and walk::prob_of_step().
    std::uint32_t width() const {
        return nodes_ == 1 ? static_cast<std::uint32_t>(root_.size()) : kWidth;
    }
    walk::Cluster<Float> cluster(const UInt32& node, std::uint32_t i, const Mask& active) const {
        if (nodes_ == 1) return root_[i];
        const UInt32 index = node * kWidth + i;
        const auto w = dr::gather<dr::Array<Float, kWords>>(clusters_, index, active);
        return {{w[0], w[1], w[2]},    w[3], w[4], w[5], {w[6], w[7], w[8]}, w[9], w[10],
                {w[11], w[12], w[13]}, w[14]};
    }
    UInt32 child(const UInt32& node, const UInt32& i, const Mask& active) const {
        const UInt32 index = node * kWidth + i;
        return dr::gather<UInt32>(children_, index, active);
    }

  private:
    struct Types {
        using Float = LightBvhArrays::Float;
        using Double = LightBvhArrays::Double;
        using UInt32 = LightBvhArrays::UInt32;
        using Mask = LightBvhArrays::Mask;
    };
    using Descent = walk::Descent<Types>;
    static constexpr std::size_t kWords = 16;
    static constexpr std::uint32_t kWidth = ::lightcull::LightBvhTable::kWidth;
    static constexpr std::uint32_t kNone = ::lightcull::LightBvhTable::kNone;

    /// Loads the clusters of the only node, which are the same for all lanes, as single numbers.
    void load_root(const ::lightcull::LightBvhTable& table) {
        const auto number = [](float x) { return dr::opaque<Float>(x); };
        const auto vec3 = [&](const ::lightcull::float3& v) {
            return walk::Vec3<Float>{number(v.x), number(v.y), number(v.z)};
        };
        for (const ::lightcull::LightBvhCluster& c : table.clusters) {
            if (c.child == ::lightcull::LightBvhTable::kEmpty) break;
            root_.push_back({vec3(c.center), number(c.radius), number(c.spread),
                             number(c.intensity), vec3(c.axis), number(c.apex), number(c.cosine),
                             vec3(c.mean_normal), number(c.diffuse)});
        }
    }

    template <typename Vector>
    static walk::Vec3<Float> to_vec3(const Vector& v) {
        return {dr::detach<false>(v.x()), dr::detach<false>(v.y()), dr::detach<false>(v.z())};
    }

    WalkPoint local(const Position& position, const Receiver<Float_>& receiver) const {
        WalkPoint point = walk::matte_point<Float>((to_vec3(position) - origin_) * inv_scale_,
                                                   to_vec3(receiver.normal));
        if (!has_lobes_) return point;
        point.has_lobe = true;
        point.diffuse = dr::detach<false>(receiver.diffuse);
        point.axis = to_vec3(receiver.axis);
        point.alpha2 = dr::square(dr::detach<false>(receiver.alpha));
        point.peak = dr::detach<false>(receiver.peak);
        return point;
    }

    walk::Vec3<Float> origin_;
    Float inv_scale_;
    std::size_t nodes_;
    bool has_lobes_;
    std::vector<walk::Cluster<Float>> root_;  ///< where it is the only node
    Float clusters_;
    UInt32 children_, parents_, leaves_;
};

}  // namespace mitsuba::culling
