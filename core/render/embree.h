#pragma once

#include "render/ray.h"

/// Embree 3 and 4 behind one face: this is the only file that knows which it is.

#if LIGHTCULL_EMBREE_VERSION == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace lightcull::embree {

/// Traces 16 rays; those with valid[i] == 0 are left alone, the others have valid[i] == -1.
inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16& rays, bool coherent) {
#if LIGHTCULL_EMBREE_VERSION == 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    arguments.feature_mask =
        static_cast<RTCFeatureFlags>(RTC_FEATURE_FLAG_TRIANGLE | RTC_FEATURE_FLAG_INSTANCE |
                                     RTC_FEATURE_FLAG_FILTER_FUNCTION_IN_GEOMETRY);
    rtcIntersect16(valid, scene, &rays, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, &rays);
#endif
}

#if LIGHTCULL_EMBREE_VERSION == 4
using Context = RTCRayQueryContext;
#else
using Context = RTCIntersectContext;
#endif

/// Embree's context of shadow rays, with what a filter wants to know.
struct ShadowContext : Context {
    const Ray* rays;  ///< rays of the packet, by their ids

    static const ShadowContext& of(const RTCFilterFunctionNArguments& hits) noexcept {
        return *static_cast<const ShadowContext*>(hits.context);
    }
};

/// Traces 16 shadow rays, whose ids are their places in `of_packet`; tfar becomes -infinity where
/// something is hit.
inline void occluded16(const int* valid, RTCScene scene, RTCRay16& rays, const Ray* of_packet) {
    ShadowContext context;
    context.rays = of_packet;
#if LIGHTCULL_EMBREE_VERSION == 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.feature_mask =
        static_cast<RTCFeatureFlags>(RTC_FEATURE_FLAG_TRIANGLE | RTC_FEATURE_FLAG_INSTANCE |
                                     RTC_FEATURE_FLAG_FILTER_FUNCTION_IN_GEOMETRY);
    rtcInitRayQueryContext(&context);
    arguments.context = &context;
    rtcOccluded16(valid, scene, &rays, &arguments);
#else
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, &rays);
#endif
}

}  // namespace lightcull::embree
