#include "gpu/shaders.h"

namespace lightcull::shaders {
namespace {

constexpr std::uint32_t kRefit[] = {
#include "refit.inc"
};
constexpr std::uint32_t kSelect[] = {
#include "select.inc"
};
constexpr std::uint32_t kPaper[] = {
#include "paper.inc"
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
