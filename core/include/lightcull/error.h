#pragma once

#include <lightcull/export.h>

#include <stdexcept>

namespace lightcull {

/// The one exception that lightcull throws: what() is one line that names the thing at fault.
class LIGHTCULL_EXPORT Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace lightcull
