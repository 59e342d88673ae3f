// Included once per instruction set.
#if defined(LIGHTCULL_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_KERNELS_INL
#undef LIGHTCULL_KERNELS_INL
#else
#define LIGHTCULL_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "lights/bvh/light_bvh_descend-inl.h"
#include "lights/groups/group_weigh-inl.h"
#include "lights/groups/packet_select-inl.h"
#include "lights/ranges/sphere_tree_refit-inl.h"
#include "lights/ranges/sphere_tree_walk-inl.h"
#include "lights/simd/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {

template <typename Node>
constexpr LightBvhKernels<Node> kBvhKernels{bvh::compute_importances, bvh::descend<Node>,
                                            bvh::prob_of_slot<Node>};

constexpr Kernels kKernels{walk::find_leaves,     groups::importance, groups::weigh,
                           packet::select_packet, refit::refit_nodes, kBvhKernels<BoundsNode>,
                           kBvhKernels<MeansNode>};

inline const Kernels* target_kernels() {
    return &kKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
