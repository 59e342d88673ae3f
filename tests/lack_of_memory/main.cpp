// Selects a batch while there is no memory for it to be put in order, then again when there is.

#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace lightcull;

/// Bytes of address space in use.
rlim_t address_space() {
    std::ifstream status("/proc/self/statm");
    rlim_t pages = 0;
    status >> pages;
    return pages * 4096;
}

/// The message of the error that select() throws; empty if it throws none.
std::string error_of_select(const LightSampler& sampler, Span<const ShadingPoint> points,
                            Span<const float> u, Span<Selection> selections) {
    try {
        sampler.select(points, u, selections);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace

int main() {
    constexpr std::size_t kPoints = std::size_t{1} << 22;
    const std::vector<Light> lights(100, point_light({1, 2, 3}, 1.0f));
    const auto sampler = make_sampler("culled:sets=16", lights);
    sampler->begin_pass(0);
    const std::vector<ShadingPoint> points(kPoints);
    const std::vector<float> u(kPoints, 0.5f);
    std::vector<Selection> selections(kPoints);
    for (Selection& selection : selections) selection.light = 77;

    tbb::task_arena arena(1);  // one thread: others would want memory, too
    rlimit unlimited{};
    getrlimit(RLIMIT_AS, &unlimited);
    constexpr rlim_t kSome = rlim_t{4} << 20;  // less than 8 bytes a point
    const rlimit limited{address_space() + kSome, unlimited.rlim_max};
    std::string refused;
    arena.execute([&] {
        setrlimit(RLIMIT_AS, &limited);
        refused = error_of_select(*sampler, points, u, selections);
        setrlimit(RLIMIT_AS, &unlimited);
    });
    std::printf("%s\n", refused.c_str());
    if (refused != "select(): no memory to put 4194304 points in order") return 1;
    for (const Selection& selection : selections) {
        if (selection.light != 77) return 2;
    }
    if (!error_of_select(*sampler, points, u, selections).empty()) return 3;
    return selections.back().prob > 0.0f ? 0 : 4;
}
