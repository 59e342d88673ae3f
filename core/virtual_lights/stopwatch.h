#pragma once

#include <ctime>

namespace lightcull {

/// The processor time that this process has taken since the stopwatch was made, all threads
/// together: unlike wall time, it does not grow where others use the machine.
class Stopwatch {
  public:
    double seconds() const noexcept {
        return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC;
    }

  private:
    std::clock_t start_ = std::clock();
};

}  // namespace lightcull
