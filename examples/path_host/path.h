#pragma once

// A path, and the steps that take it from one surface to the next. They are the same for all orders
// of work, and all that has to do with multiple importance sampling is here.

#include <lightcull/light_sampler.h>

#include <cstdint>
#include <optional>

#include "host.h"
#include "surface.h"

namespace host {

struct Path {
    Random random;
    Ray ray;
    float3 weight{1, 1, 1};
    float3 radiance{0, 0, 0};  ///< radiance that the path has brought to the camera

    // The place where the ray comes from. MIS asks for it when the ray hits a light.
    bool from_camera = true;
    lightcull::ShadingPoint left;
    lightcull::Receipt receipt;
    float bsdf_pdf = 0.0f;

    // The place where the ray has arrived.
    Surface surface;
    float3 position;
};

/// A camera ray for a sample of a pixel.
Path start(const Scene& scene, const Job& job, std::uint32_t pixel, std::uint32_t sample);

/// Follows the ray, and adds the light that it meets. False where the path ends.
bool arrive(const Scene& scene, const lightcull::LightSelector& selector, std::uint32_t bounce,
            Path& path);

/// The surface where the path is, as lightcull wants to know it.
lightcull::ShadingPoint shading_point(const Path& path, std::uint32_t set);

/// Does light sampling: adds light from the emitter that was selected, and from the sky. Returns
/// what the shadow ray to the emitter found, 1 if it is visible and 0 if not; nothing if there was
/// no such ray.
std::optional<float> add_light(const Scene& scene, const lightcull::Selection& selection,
                               Path& path);

/// Does BSDF sampling: makes the next ray, which takes along what MIS will ask for. False where the
/// path ends.
bool leave(const lightcull::ShadingPoint& point, const lightcull::Selection& selection, Path& path);

}  // namespace host
