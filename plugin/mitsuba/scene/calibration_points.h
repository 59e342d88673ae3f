#pragma once

#include <lightcull/light_sampler.h>

#include <mitsuba/render/scene.h>
#include <mitsuba/render/sensor.h>

#include <vector>

namespace mitsuba::culling {

/// Some hundred points that the camera sees, and as many again that one bounce from there reaches,
/// to calibrate a light sampler on.
template <typename Float, typename Spectrum>
std::vector<::lightcull::ShadingPoint> typical_points(const Scene<Float, Spectrum>* scene,
                                                      const Sensor<Float, Spectrum>* sensor);

}  // namespace mitsuba::culling
