#pragma once

#include <nanothread/nanothread.h>
#include <tbb/task_arena.h>

#include <memory>

namespace mitsuba::culling {

/// Calls the function where light samplers run with as many threads as Mitsuba uses. There is an
/// arena for each thread that calls: in one that is full, another thread would run the function.
/// Arenas are kept, since TBB never frees all of one.
template <typename Function>
void in_sampler_arena(const Function& function) {
    thread_local std::unique_ptr<tbb::task_arena> arena;
    const auto threads = static_cast<int>(pool_size());
    if (!arena || arena->max_concurrency() != threads) {
        arena = std::make_unique<tbb::task_arena>(threads);
    }
    arena->execute(function);
}

}  // namespace mitsuba::culling
