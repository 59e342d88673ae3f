#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <cmath>
#include <string>

#include "lights/baselines/paper_scene.h"
#include "lights/ranges/set_count.h"
#include "lights/spec/check_range_options.h"

namespace lightcull {
namespace {

void check_positive(float value, const char* name) {
    if (value > 0.0f && std::isfinite(value)) return;
    throw Error(std::string(name) + " is " + std::to_string(value) + ", wanted finite and above 0");
}

void check(const CulledOptions& options) {
    check_range_options(options.range);
    if (options.set_count) check_set_count(*options.set_count);
    if (options.group_size == 0u) throw Error("group is 0, wanted 1 or more");
}

void check(const LearnedOptions& options) {
    if (options.rounds == 0) throw Error("rounds is 0, wanted 1 or more");
    if (options.memory_mib == 0) throw Error("memory is 0, wanted 1 MiB or more");
}

void check(const PaperOptions& options) {
    check_range_options(options.range);
    check_set_count(options.set_count);
    if (options.list_size <= PaperScene::kMaxListSize) return;
    throw Error("list is " + std::to_string(options.list_size) + ", wanted 0 to " +
                std::to_string(PaperScene::kMaxListSize));
}

void check(const ClampedOptions& options) {
    check_range_options(options.range);
}

void check(const LightBvhOptions&) {
}
void check(const UniformOptions&) {
}
void check(const PowerOptions&) {
}
void check(const ExhaustiveOptions&) {
}

}  // namespace

void check_range_options(const RangeOptions& options) {
    if (options.error_bound) check_positive(*options.error_bound, "error_bound");
    check_positive(options.expected_accepted, "expected_accepted");
    check_positive(options.exposure, "exposure");
}

void check_sampler(const SamplerSpec& spec) {
    std::visit([](const auto& options) { check(options); }, spec);
}

}  // namespace lightcull
