#pragma once

#include <lightcull/lightcull.h>

#include <utility>

/// How errors leave the library towards C: as a code, and as a text that the thread keeps.

namespace lightcull {

/// Keeps the text of the exception that is being handled for lightcull_last_error(). of_error: the
/// code for an Error.
lightcull_error keep_current_exception(lightcull_error of_error) noexcept;

/// Runs a function; no exception comes out.
template <typename Function>
lightcull_error guarded(Function&& function,
                        lightcull_error of_error = LIGHTCULL_INVALID_ARGUMENT) noexcept {
    try {
        std::forward<Function>(function)();
        return LIGHTCULL_OK;
    } catch (...) {
        return keep_current_exception(of_error);
    }
}

/// Throws Error where `pointer` is null.
void check_not_null(const void* pointer, const char* name);

}  // namespace lightcull
