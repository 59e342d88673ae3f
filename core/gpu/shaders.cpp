#include "gpu/shaders.h"

namespace lightcull::shaders {
namespace {

constexpr std::uint32_t kRefit[] = {
#include "sphere_tree_refit.inc"
};
constexpr std::uint32_t kSelect[] = {
#include "culled_sampler.inc"
};
constexpr std::uint32_t kPaper[] = {
#include "paper_sampler.inc"
};

}  // namespace

Span<const std::uint32_t> refit() noexcept {
    return kRefit;
}
Span<const std::uint32_t> select() noexcept {
    return kSelect;
}
Span<const std::uint32_t> paper() noexcept {
    return kPaper;
}

}  // namespace lightcull::shaders
