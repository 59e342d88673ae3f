#pragma once

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

}  // namespace mitsuba::culling
