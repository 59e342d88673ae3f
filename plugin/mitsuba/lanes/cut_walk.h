#pragma once

#include <cmath>
#include <cstdint>

namespace mitsuba::culling {

/// A place in a triangle, by the weights of its corners, on its way down a tree of
/// lightcull::TriangleCuts: the twin of TriangleCuts::at(), for a number or for Dr.Jit arrays.
template <typename Float>
struct WeightsInNode {
    Float of[3];

    /// Goes down to the half that holds the place, where the edge from corner `edge` is bisected.
    /// Select: select(mask, a, b). Returns whether it is the second half.
    template <typename UInt32, typename Select>
    auto step(const UInt32& edge, const Select& select) {
        const auto is_0 = edge == std::uint32_t{0}, is_1 = edge == std::uint32_t{1};
        const Float from = select(is_0, of[0], select(is_1, of[1], of[2]));
        const Float to = select(is_0, of[1], select(is_1, of[2], of[0]));
        const auto second = from < to;
        const Float new_from = select(second, 2.0f * from, from - to);
        const Float new_to = select(second, to - from, 2.0f * to);
        of[0] = select(is_0, new_from, select(is_1, of[0], new_to));
        of[1] = select(is_0, new_to, select(is_1, new_from, of[1]));
        of[2] = select(is_0, of[2], select(is_1, new_to, new_from));
        return second;
    }
};

/// Draws a place by two numbers in [0, 1) with a density that is linear between `weights` at the
/// corners, which have a sum of 1: the weights of the corners there. It is as
/// TriangleCuts::draw_place() does it where the density is not even.
template <typename Float, typename Select>
WeightsInNode<Float> draw_linear(const Float (&weights)[3], const Float& u, const Float& v,
                                 const Select& select) {
    using std::asin, std::sin;
    const Float both = weights[0] + weights[1];
    const auto is_0 = u < weights[0], is_1 = u < both;
    const Float before = select(is_0, Float(0.0f), select(is_1, weights[0], both));
    const Float weight = select(is_0, weights[0], select(is_1, weights[1], weights[2]));
    const Float place = (u - before) / weight;
    const Float in_range = select(place < 1.0f, place, Float(1.0f));
    const Float own = 0.5f - sin(asin(1.0f - 2.0f * in_range) / 3.0f);
    const Float next = (1.0f - own) * (1.0f - v), last = (1.0f - own) * v;
    return {{select(is_0, own, select(is_1, last, next)),
             select(is_0, next, select(is_1, own, last)),
             select(is_0, last, select(is_1, next, own))}};
}

}  // namespace mitsuba::culling
