#include "registration.h"

namespace lightcull::bench {

void add([[maybe_unused]] const std::string& name,
         [[maybe_unused]] const std::function<void(benchmark::State&)>& function,
         [[maybe_unused]] bool once) {
#ifndef __clang_analyzer__  // the analyzer takes for a leak what the library keeps
    auto* added = benchmark::RegisterBenchmark(name.c_str(), function);
    added->Unit(benchmark::kMillisecond)->UseRealTime();
    if (once) added->Iterations(1);
#endif
}

std::string setting_name(std::uint32_t light_count, int threads) {
    return "/lights:" + std::to_string(light_count) + "/threads:" + std::to_string(threads);
}

}  // namespace lightcull::bench
