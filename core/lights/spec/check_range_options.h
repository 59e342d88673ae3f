#pragma once

#include <lightcull/samplers.h>

namespace lightcull {

/// Throws Error, with a message that names the option, if one makes no sense.
void check_range_options(const RangeOptions& options);

}  // namespace lightcull
