#pragma once

#include <drjit/array_traits.h>

#include <type_traits>

#include "loop/kernel_lights.h"
#include "volume/scalar_volume_lights.h"

namespace mitsuba::culling {

/// What chooses and samples lights for points in media and on surfaces.
template <typename Float, typename Spectrum>
using VolumeLights = std::conditional_t<drjit::is_jit_v<Float>, KernelLights<Float, Spectrum>,
                                        ScalarVolumeLights<Float, Spectrum>>;

}  // namespace mitsuba::culling
