#pragma once

namespace mitsuba::culling {

/// Whether the numbers of a Mitsuba sampler are independent of each other, so that any seed gives
/// as good ones.
template <typename Sampler>
bool is_independent(const Sampler* sampler) {
    return sampler->class_name() == "IndependentSampler";
}

}  // namespace mitsuba::culling
