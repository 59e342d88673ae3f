#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/lightcull.h>

#include <cstddef>
#include <type_traits>

/// What hot calls take and give is the same in C and in C++, so that arrays are not converted, and
/// handles are the C++ objects themselves, so that there is nothing to look up.

namespace lightcull {

#define LIGHTCULL_SAME_FIELD(c_struct, cpp_struct, field)                     \
    static_assert(offsetof(c_struct, field) == offsetof(cpp_struct, field) && \
                  sizeof(c_struct::field) == sizeof(cpp_struct::field))
#define LIGHTCULL_SAME_STRUCT(c_struct, cpp_struct)                                           \
    static_assert(                                                                            \
        sizeof(c_struct) == sizeof(cpp_struct) && alignof(c_struct) == alignof(cpp_struct) && \
        std::is_standard_layout_v<cpp_struct> && std::is_trivially_copyable_v<cpp_struct>)

LIGHTCULL_SAME_STRUCT(lightcull_lobe, GlossyLobe);
LIGHTCULL_SAME_FIELD(lightcull_lobe, GlossyLobe, axis);
LIGHTCULL_SAME_FIELD(lightcull_lobe, GlossyLobe, alpha);
LIGHTCULL_SAME_FIELD(lightcull_lobe, GlossyLobe, peak);

LIGHTCULL_SAME_STRUCT(lightcull_shading_point, ShadingPoint);
LIGHTCULL_SAME_FIELD(lightcull_shading_point, ShadingPoint, position);
LIGHTCULL_SAME_FIELD(lightcull_shading_point, ShadingPoint, normal);
LIGHTCULL_SAME_FIELD(lightcull_shading_point, ShadingPoint, set);
LIGHTCULL_SAME_FIELD(lightcull_shading_point, ShadingPoint, diffuse);
LIGHTCULL_SAME_FIELD(lightcull_shading_point, ShadingPoint, lobe);

LIGHTCULL_SAME_STRUCT(lightcull_receipt, Receipt);
LIGHTCULL_SAME_FIELD(lightcull_receipt, Receipt, weight_sum);
LIGHTCULL_SAME_FIELD(lightcull_receipt, Receipt, key);

LIGHTCULL_SAME_STRUCT(lightcull_selection, Selection);
LIGHTCULL_SAME_FIELD(lightcull_selection, Selection, light);
LIGHTCULL_SAME_FIELD(lightcull_selection, Selection, prob);
LIGHTCULL_SAME_FIELD(lightcull_selection, Selection, mis_prob);
LIGHTCULL_SAME_FIELD(lightcull_selection, Selection, receipt);

LIGHTCULL_SAME_STRUCT(lightcull_outcome, LightOutcome);
LIGHTCULL_SAME_FIELD(lightcull_outcome, LightOutcome, position);
LIGHTCULL_SAME_FIELD(lightcull_outcome, LightOutcome, normal);
LIGHTCULL_SAME_FIELD(lightcull_outcome, LightOutcome, receipt);
LIGHTCULL_SAME_FIELD(lightcull_outcome, LightOutcome, light);
LIGHTCULL_SAME_FIELD(lightcull_outcome, LightOutcome, visibility);

#undef LIGHTCULL_SAME_FIELD
#undef LIGHTCULL_SAME_STRUCT

inline const ShadingPoint* to_cpp(const lightcull_shading_point* points) noexcept {
    return reinterpret_cast<const ShadingPoint*>(points);
}
inline const Receipt* to_cpp(const lightcull_receipt* receipt) noexcept {
    return reinterpret_cast<const Receipt*>(receipt);
}
inline const LightOutcome* to_cpp(const lightcull_outcome* outcomes) noexcept {
    return reinterpret_cast<const LightOutcome*>(outcomes);
}
inline Selection* to_cpp(lightcull_selection* selections) noexcept {
    return reinterpret_cast<Selection*>(selections);
}

inline lightcull_sampler* to_c(LightSampler* sampler) noexcept {
    return reinterpret_cast<lightcull_sampler*>(sampler);
}
inline LightSampler* to_cpp(lightcull_sampler* sampler) noexcept {
    return reinterpret_cast<LightSampler*>(sampler);
}
inline const LightSampler* to_cpp(const lightcull_sampler* sampler) noexcept {
    return reinterpret_cast<const LightSampler*>(sampler);
}
inline const lightcull_pass* to_c(const LightSelector* pass) noexcept {
    return reinterpret_cast<const lightcull_pass*>(pass);
}
inline const LightSelector* to_cpp(const lightcull_pass* pass) noexcept {
    return reinterpret_cast<const LightSelector*>(pass);
}

}  // namespace lightcull
