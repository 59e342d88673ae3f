#pragma once

#include <drjit/array_traits.h>
#include <mitsuba/core/logger.h>

#include <exception>

namespace mitsuba::culling {

/// Calls the function. Where mi.render() has Dr.Jit call it, an error would come out as one of
/// Dr.Jit that says nothing; the log shows it as it is.
template <typename Float, typename Function>
auto with_errors_in_log(const Function& function) -> decltype(function()) {
    if constexpr (drjit::is_jit_v<Float>) {
        try {
            return function();
        } catch (const std::exception& error) {
            Log(Warn, "%s", error.what());
            throw;
        }
    } else {
        return function();
    }
}

}  // namespace mitsuba::culling
