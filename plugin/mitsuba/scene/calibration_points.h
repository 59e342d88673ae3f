#pragma once

#include <lightcull/light_sampler.h>

#include <mitsuba/render/scene.h>
#include <mitsuba/render/sensor.h>

#include <vector>

namespace mitsuba::culling {

/// The points to calibrate a light sampler on: some hundred that the camera sees, and as many again
/// that one bounce from there reaches. Points that meet nothing are left out, so there may be none.
template <typename Float, typename Spectrum>
std::vector<::lightcull::ShadingPoint> calibration_points(const Scene<Float, Spectrum>* scene,
                                                          const Sensor<Float, Spectrum>* sensor);

}  // namespace mitsuba::culling
