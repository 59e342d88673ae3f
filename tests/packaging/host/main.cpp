// What a host relies on, wherever the library is: its version, errors that are caught by their
// type, and samplers that a second library of lightcull tells apart by theirs.

#include <lightcull/error.h>
#include <lightcull/samplers.h>
#include <lightcull/version.h>
#ifdef WITH_GPU
#include <lightcull/gpu/vulkan_sampler.h>
#endif

#include <cstdio>
#include <vector>

namespace {

/// The Error that a call throws, if it throws one.
template <typename Call>
void print_error(const char* name, Call&& call) {
    try {
        call();
        std::printf("%s: no error\n", name);
    } catch (const lightcull::Error& error) {
        std::printf("%s: %s\n", name, error.what());
    }
}

}  // namespace

int main() {
    std::printf("headers %s, library %s\n", LIGHTCULL_VERSION_STRING, lightcull::version());
    print_error("unknown", [] { lightcull::make_sampler("no_such", {}); });

    const std::vector<lightcull::Light> lights(10, lightcull::point_light({0, 1, 0}, 1.0f));
    const auto culled = lightcull::make_sampler("culled", lights);
    culled->begin_pass(0);
    const lightcull::Selection chosen = culled->select(lightcull::ShadingPoint{}, 0.5f);
    std::printf("chosen: %d\n", chosen.prob > 0.0f && chosen.light < lights.size());
#ifdef WITH_GPU
    for (const char* name : {"uniform", "culled"}) {
        print_error(name, [&] {
            lightcull::make_vulkan_sampler(lightcull::make_sampler(name, lights),
                                           {"a device of no such name", 1.0});
        });
    }
#endif
}
