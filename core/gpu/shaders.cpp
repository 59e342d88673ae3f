#include "gpu/shaders.h"

namespace lightcull::shaders {
namespace {

constexpr std::uint32_t kRefit[] = {
#include "refit.inc"
};
constexpr std::uint32_t kSelect[] = {
#include "select.inc"
};

}  // namespace

Span<const std::uint32_t> refit() noexcept {
    return kRefit;
}
Span<const std::uint32_t> select() noexcept {
    return kSelect;
}

}  // namespace lightcull::shaders
