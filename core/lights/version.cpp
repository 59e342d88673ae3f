#include <lightcull/version.h>

namespace lightcull {

const char* version() noexcept {
    return LIGHTCULL_VERSION_STRING;
}

}  // namespace lightcull
