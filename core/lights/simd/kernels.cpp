#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/simd/kernels.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include "lights/simd/kernels-inl.h"

#if HWY_ONCE

#include <lightcull/error.h>
#include <lightcull/instruction_set.h>

#include <algorithm>
#include <atomic>

namespace lightcull {
namespace {

HWY_EXPORT(target_kernels);

/// Stands for scalar_kernels() among Highway's targets, not all of which may have a scalar one.
constexpr std::int64_t kScalar = 0;

const Kernels* kernels_of(std::int64_t target) {
    if (target == kScalar) return &scalar_kernels();
    hwy::GetChosenTarget().Update(target);
    return HWY_DYNAMIC_DISPATCH(target_kernels)();
}

/// Best first.
std::vector<std::int64_t> targets() {
    std::vector<std::int64_t> all;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        if (target != HWY_SCALAR && target != HWY_EMU128) all.push_back(target);
    }
    std::sort(all.begin(), all.end());  // better ones have lower bits
    all.push_back(kScalar);
    return all;
}

std::string name_of(std::int64_t target) {
    return target == kScalar ? "scalar" : hwy::TargetName(target);
}

struct InUse {
    std::atomic<std::int64_t> target;
    std::atomic<const Kernels*> kernels;

    InUse() : target(targets().front()), kernels(kernels_of(target)) {}
};

InUse& in_use() {
    static InUse in_use;
    return in_use;
}

}  // namespace

const Kernels& kernels() noexcept {
    return *in_use().kernels.load(std::memory_order_relaxed);
}

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const std::int64_t target : targets()) names.push_back(name_of(target));
    return names;
}

std::string instruction_set() {
    return name_of(in_use().target);
}

void use_instruction_set(std::string_view name) {
    std::string known;
    for (const std::int64_t target : targets()) {
        if (name_of(target) == name) {
            in_use().target = target;
            in_use().kernels = kernels_of(target);
            return;
        }
        known += (known.empty() ? "" : ", ") + name_of(target);
    }
    throw Error("no instruction set '" + std::string(name) + "' on this machine; there are " +
                known);
}

}  // namespace lightcull
#endif
