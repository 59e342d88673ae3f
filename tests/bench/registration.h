#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <string>

namespace lightcull::bench {

/// Adds a benchmark by wall time. once: the benchmark runs a single time.
void add(const std::string& name, const std::function<void(benchmark::State&)>& function,
         bool once = false);

/// The end of a benchmark's name.
std::string setting_name(std::uint32_t light_count, int threads);

}  // namespace lightcull::bench
