#include "lights/c_api/c_error.h"

#include <lightcull/error.h>

#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace lightcull {
namespace {

/// The text of the last error. It lies outside the heap, as it may be that memory lacks.
thread_local char last_error[1024] = "";

void keep(const char* text) noexcept {
    std::snprintf(last_error, sizeof last_error, "%s", text);
}

}  // namespace

lightcull_error keep_current_exception(lightcull_error of_error) noexcept {
    try {
        throw;
    } catch (const Error& error) {
        keep(error.what());
        return of_error;
    } catch (const std::bad_alloc&) {
        keep("out of memory");
        return LIGHTCULL_OUT_OF_MEMORY;
    } catch (const std::length_error&) {  // more than a vector can ever hold
        keep("out of memory");
        return LIGHTCULL_OUT_OF_MEMORY;
    } catch (const std::exception& error) {
        keep(error.what());
    } catch (...) {
        keep("an exception of unknown type");
    }
    return LIGHTCULL_FAILED;
}

void check_not_null(const void* pointer, const char* name) {
    if (pointer == nullptr) throw Error(std::string(name) + " is null");
}

}  // namespace lightcull

const char* lightcull_last_error(void) {
    return lightcull::last_error;
}
