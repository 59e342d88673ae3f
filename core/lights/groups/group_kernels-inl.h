// Included once per instruction set.
#if defined(LIGHTCULL_GROUP_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_GROUP_KERNELS_INL
#undef LIGHTCULL_GROUP_KERNELS_INL
#else
#define LIGHTCULL_GROUP_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "lights/groups/group_kernels.h"
#include "lights/groups/group_weigh-inl.h"
#include "lights/groups/packet_select-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {

constexpr GroupKernels kGroupKernels{groups::importance, groups::weigh, packet::select_packet};

inline const GroupKernels& target_group_kernels() {
    return kGroupKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
