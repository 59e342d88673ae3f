#pragma once

#include <lightcull/samplers.h>

#include "base/core_export.h"

namespace lightcull {

/// Throws Error, with a message that names the option, if an option makes no sense.
LIGHTCULL_CORE_EXPORT void check_range_options(const RangeOptions& options);

}  // namespace lightcull
