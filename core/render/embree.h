#pragma once

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
    arguments.feature_mask = RTC_FEATURE_FLAG_TRIANGLE;
    rtcIntersect16(valid, scene, &rays, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, &rays);
#endif
}

/// Traces 16 shadow rays; tfar becomes -infinity where something is hit.
inline void occluded16(const int* valid, RTCScene scene, RTCRay16& rays) {
#if LIGHTCULL_EMBREE_VERSION == 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.feature_mask = RTC_FEATURE_FLAG_TRIANGLE;
    rtcOccluded16(valid, scene, &rays, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, &rays);
#endif
}

}  // namespace lightcull::embree
