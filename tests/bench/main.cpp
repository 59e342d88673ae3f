#include "benchmarks.h"

#include <benchmark/benchmark.h>

/// Measures what selecting a light costs, against a shadow ray, what builds and refits cost, and
/// what a render costs beside its rays. Take a part with --benchmark_filter=REGEX, as in
/// 'select/culled/.*/lights:54720/.*threads:1'.
int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    for (const std::uint32_t lights : {1'000u, 10'000u, 54'720u, 250'000u, 1'000'000u}) {
        lightcull::bench::register_building(lights);
        lightcull::bench::register_selection(lights);
        lightcull::bench::register_rays(lights);
    }
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
