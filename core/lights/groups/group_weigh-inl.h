// Included once per instruction set.
#if defined(LIGHTCULL_GROUP_WEIGH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_GROUP_WEIGH_INL
#undef LIGHTCULL_GROUP_WEIGH_INL
#else
#define LIGHTCULL_GROUP_WEIGH_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "base/reservoir.h"
#include "lights/bvh/cluster_importance-inl.h"
#include "lights/groups/light_groups.h"
#include "lights/ranges/range_tree.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace groups {
namespace hn = hwy::HWY_NAMESPACE;

/// The random numbers of Reservoir::add().
template <class D, class VU>
HWY_ATTR HWY_INLINE hn::Vec<D> random_numbers(D d, VU u_bits, VU record) {
    const hn::RebindToUnsigned<D> du;
    auto bits = hn::Xor(u_bits, hn::Mul(record, hn::Set(du, Reservoir::kStride)));
    bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<16>(bits)), hn::Set(du, 0x85ebca6bu));
    bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<13>(bits)), hn::Set(du, 0xc2b2ae35u));
    bits = hn::Xor(bits, hn::ShiftRight<16>(bits));
    // Halves are exact as floats, so their sum is rounded once, as a conversion would be.
    const hn::RebindToSigned<D> ds;
    const auto high = hn::ConvertTo(d, hn::BitCast(ds, hn::ShiftRight<16>(bits)));
    const auto low = hn::ConvertTo(d, hn::BitCast(ds, hn::And(bits, hn::Set(du, 0xffffu))));
    const auto number = hn::Add(hn::Mul(high, hn::Set(d, 0x1p16f)), low);
    return hn::Min(hn::Mul(number, hn::Set(d, 0x1p-32f)), hn::Set(d, Reservoir::kBelowOne));
}

/// The inverse 1 / p of [TH16] Eq. 1, by the arithmetic of RandomRanges.
template <class D>
HWY_ATTR HWY_INLINE hn::Vec<D> inverse_probs(D d, hn::Vec<D> distance2, hn::Vec<D> radius,
                                             hn::Vec<D> inverse_limit) {
    const auto distance = hn::Max(hn::Sub(hn::Sqrt(distance2), radius), hn::Zero(d));
    return hn::Max(hn::Mul(hn::Mul(distance, distance), inverse_limit), hn::Set(d, 1.0f));
}

HWY_ATTR inline float importance(const LightGroup& group, const Receiver& receiver) {
    using D = hn::CappedTag<float, 1>;
    const D d;
    const ReceiverLanes<D, Receiver> receivers{receiver};
    const cluster::Ways<D> ways(receivers, group.center, 0);
    const auto height = ways.height_over(receivers);
    const auto reached = cluster::may_reach(d, group, 0, receivers, ways, height);
    const auto g = cluster::mean_importance(d, group, 0, receivers, ways, height);
    return hn::GetLane(hn::IfThenElseZero(reached, g));
}

/// A block of groups side by side; places without a group are 0.
constexpr std::size_t kBlock = 16;
struct alignas(64) GroupBlock : ClusterMeans<kBlock> {
    std::uint32_t records[kBlock];
    float weights[kBlock], sums[kBlock];

    HWY_ATTR GroupBlock() {
        const hn::CappedTag<std::uint8_t, 64> d;
        auto* bytes = reinterpret_cast<std::uint8_t*>(this);
        // The loop stands in place of "= {}", for which compilers call a memset that costs more
        // than a block's weights.
        for (std::size_t i = 0; i < sizeof *this; i += hn::Lanes(d)) {
            hn::Store(hn::Zero(d), d, bytes + i);
        }
    }
};

/// Adds groups to a choice one after the other.
HWY_ATTR inline void weigh_block(const RangeTree& tree, GroupBlock& block, std::size_t count,
                                 const Receiver& receiver, std::uint32_t u_bits,
                                 GroupChoice& choice) {
    using D = hn::CappedTag<float, kBlock>;
    const D d;
    const hn::RebindToUnsigned<D> du;
    const ReceiverLanes<D, Receiver> receivers{receiver};
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const cluster::Ways<D> ways(receivers, block.center, i);
        const auto height = ways.height_over(receivers);
        const auto reached = cluster::may_reach(d, block, i, receivers, ways, height);
        const auto g = hn::IfThenElseZero(
            reached, cluster::mean_importance(d, block, i, receivers, ways, height));
        const auto limit =
            hn::Max(hn::Mul(hn::Set(d, tree.ranges().reach()), hn::Load(d, block.intensity + i)),
                    hn::Set(d, RandomRanges::kLeastLimit));
        const auto inverse_prob = inverse_probs(d, ways.distance2, hn::Load(d, block.radius + i),
                                                hn::Div(hn::Set(d, 1.0f), limit));
        const auto weight = hn::Mul(g, inverse_prob);
        hn::Store(weight, d, block.weights + i);
        // The sums are taken in the order of the groups.
        const std::size_t end = std::min(count, i + hn::Lanes(d));
        float sum = choice.weight_sum;
        for (std::size_t j = i; j < end; ++j) block.sums[j] = sum += block.weights[j];
        choice.weight_sum = sum;

        const auto random = random_numbers(d, hn::Set(du, u_bits), hn::Load(du, block.records + i));
        const auto sums = hn::Load(d, block.sums + i);
        const auto chosen =
            hn::And(hn::Gt(weight, hn::Zero(d)), hn::Lt(hn::Mul(random, sums), weight));
        const auto in_block = hn::FirstN(d, end - i);
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, hn::And(chosen, in_block), bytes);
        const std::uint32_t bits = bytes[0] | std::uint32_t{bytes[1]} << 8;
        if (bits == 0) continue;
        const std::size_t last = i + 31 - hwy::Num0BitsAboveMS1Bit_Nonzero32(bits);
        choice.record = block.records[last];
        hn::Store(g, d, block.weights + i);
        choice.numerator = block.weights[last];
    }
}

HWY_ATTR inline void weigh(const RangeTree& tree, const LightGroup* groups,
                           Span<const std::uint32_t> records, const Receiver& receiver,
                           std::uint32_t u_bits, GroupChoice& choice) {
    GroupBlock block;
    for (std::size_t begin = 0; begin < records.size(); begin += kBlock) {
        const std::size_t count = std::min(records.size() - begin, kBlock);
        for (std::size_t i = 0; i < count; ++i) {
            block.set(i, groups[records[begin + i]], 0);
            block.records[i] = records[begin + i];
        }
        weigh_block(tree, block, count, receiver, u_bits, choice);
    }
}

}  // namespace groups
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
