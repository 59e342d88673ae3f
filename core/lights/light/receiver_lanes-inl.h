// Included once per instruction set.
#if defined(LIGHTCULL_RECEIVER_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_RECEIVER_LANES_INL
#undef LIGHTCULL_RECEIVER_LANES_INL
#else
#define LIGHTCULL_RECEIVER_LANES_INL
#endif

#include <hwy/highway.h>

#include "lights/light/receiver_packet.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Receivers in the lanes of vectors. Form is Receiver: the same receiver in all lanes; or
/// ReceiverPacket: as many of its receivers as there are lanes, from the i-th on.
template <class D, class Form>
struct ReceiverLanes {
    using V = hn::Vec<D>;
    const Form& of;
    std::size_t i = 0;

    HWY_ATTR V position(std::size_t k) const { return component(of.position, k); }
    HWY_ATTR V normal(std::size_t k) const { return component(of.normal, k); }
    HWY_ATTR V from_all_sides() const { return load(of.from_all_sides); }
    HWY_ATTR V horizon() const { return load(of.horizon); }
    bool has_lobe() const { return of.has_lobe(); }
    HWY_ATTR V diffuse() const { return load(of.diffuse); }
    HWY_ATTR V axis(std::size_t k) const { return component(of.axis, k); }
    HWY_ATTR V alpha2() const { return load(of.alpha2); }
    HWY_ATTR V peak() const { return load(of.peak); }

  private:
    HWY_ATTR V load(const float& value) const { return hn::Set(D(), value); }
    HWY_ATTR V load(const float (&values)[ReceiverPacket::kSize]) const {
        return hn::Load(D(), values + i);
    }
    HWY_ATTR V component(const float3& v, std::size_t k) const {
        return load(k == 0 ? v.x : k == 1 ? v.y : v.z);
    }
    HWY_ATTR V component(const float (&v)[3][ReceiverPacket::kSize], std::size_t k) const {
        return load(v[k]);
    }
};

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
