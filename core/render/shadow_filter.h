#pragma once

#include "render/ray.h"

#include <cstdint>

struct RTCFilterFunctionNArguments;  // Embree's

namespace lightcull {

struct SceneData;

/// Triangles of a scene: the user data of filter_shadow_hits().
struct Triangles {
    const SceneData* scene;
    std::uint32_t first;           ///< index of the first triangle
    std::uint32_t first_instance;  ///< Embree's id of the first instance
    float distance_unit;  ///< a distance along a ray as Embree has it, over that of the ray
};

/// Whether a triangle that a ray hits at `distance`, in lengths of its direction, lies before the
/// end of the ray: whether its plane parts the ends, by more than what rounding has moved the end.
/// So nothing hides a place in its own plane, and a plate right before a lamp hides the lamp.
bool hides_end(const SceneData& scene, const Hit& hit, float distance, const Ray& ray) noexcept;

/// Embree's filter of hits: keeps those where a triangle is not cut out.
void filter_cut_outs(const RTCFilterFunctionNArguments* hits);

/// The same of shadow rays, with a ShadowContext: keeps those that hide the end, too.
void filter_shadow_hits(const RTCFilterFunctionNArguments* hits);

}  // namespace lightcull
