#pragma once

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>

namespace lightcull::python {

/// The number of threads that an arena gets where `threads` are wanted; 0: as many as the machine
/// has, and never more.
inline int arena_size(std::uint32_t threads) {
    const int available = tbb::info::default_concurrency();
    return threads == 0 || threads > static_cast<std::uint32_t>(available)
               ? available
               : static_cast<int>(threads);
}

}  // namespace lightcull::python
