#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

namespace lightcull {

/// Calls run(begin, end) for blocks of `block` that make up [0, size), in the caller's arena. While
/// a thread waits for the others it takes on no other work of the caller's, which may hold what the
/// caller is using here.
template <typename Run>
void for_each_block(std::size_t size, std::size_t block, Run&& run) {
    if (size <= block) {
        if (size > 0) run(std::size_t{0}, size);
        return;
    }
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, (size + block - 1) / block,
                          [&](std::size_t i) { run(i * block, std::min((i + 1) * block, size)); });
    });
}

}  // namespace lightcull
