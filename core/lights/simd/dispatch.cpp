#include "lights/simd/dispatch.h"

#include <hwy/highway.h>
#include <lightcull/error.h>
#include <lightcull/instruction_set.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace lightcull {
namespace {

/// Keeps Highway's choice for the process. hwy::SupportedTargets() also makes that choice anew,
/// whatever others chose or disabled; this puts it back. Highway has no function that tells all of
/// a choice.
class KeepChosenTarget {
  public:
    KeepChosenTarget() noexcept : mask_(mask().load()) {}
    ~KeepChosenTarget() { mask().store(mask_); }
    KeepChosenTarget(const KeepChosenTarget&) = delete;
    KeepChosenTarget& operator=(const KeepChosenTarget&) = delete;

  private:
    using Mask = std::atomic<std::int64_t>;
    // hwy::ChosenTarget has standard layout, so that its only member lies where the object does.
    static_assert(std::is_standard_layout_v<hwy::ChosenTarget> &&
                  sizeof(hwy::ChosenTarget) == sizeof(Mask));

    static Mask& mask() noexcept { return reinterpret_cast<Mask&>(hwy::GetChosenTarget()); }

    std::int64_t mask_;
};

struct InstructionSet {
    std::string name;
    std::size_t index;  ///< index in tables, as dispatch_index() gives it
};

std::size_t index_of(std::int64_t target) noexcept {
    hwy::ChosenTarget chosen;
    chosen.Update(target);
    return chosen.GetIndex();
}

std::vector<InstructionSet> find_instruction_sets() {
    const KeepChosenTarget keep;
    std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
    std::sort(targets.begin(), targets.end());  // better targets have lower bits
    std::vector<InstructionSet> all;
    for (const std::int64_t target : targets) {
        if (target == HWY_SCALAR || target == HWY_EMU128) continue;
        all.push_back({hwy::TargetName(target), index_of(target)});
    }
    all.push_back({"scalar", kScalarIndex});
    return all;
}

/// All instruction sets, best first.
const std::vector<InstructionSet>& all_instruction_sets() {
    static const std::vector<InstructionSet> all = find_instruction_sets();
    return all;
}

std::atomic<std::size_t>& index_in_use() {
    static std::atomic<std::size_t> index(all_instruction_sets().front().index);
    return index;
}

}  // namespace

std::size_t dispatch_index() noexcept {
    return index_in_use().load(std::memory_order_relaxed);
}

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const InstructionSet& set : all_instruction_sets()) names.push_back(set.name);
    return names;
}

std::string instruction_set() {
    const std::vector<InstructionSet>& all = all_instruction_sets();
    const std::size_t index = dispatch_index();
    return std::find_if(all.begin(), all.end(),
                        [&](const InstructionSet& set) { return set.index == index; })
        ->name;
}

void use_instruction_set(std::string_view name) {
    std::string known;
    for (const InstructionSet& set : all_instruction_sets()) {
        if (set.name == name) {
            index_in_use() = set.index;
            return;
        }
        known += (known.empty() ? "" : ", ") + set.name;
    }
    throw Error("no instruction set '" + std::string(name) + "' on this machine; there are " +
                known);
}

}  // namespace lightcull
