#pragma once

#include <cstddef>

namespace lightcull {

/// Each room has a table of kernels, its loops that matter, compiled once per instruction set by
/// Highway and once for one lane. Which of them serves is chosen here, for this library alone:
/// Highway's own choice (hwy::GetChosenTarget) is one for the process, and so for whoever else uses
/// Highway in it.

/// The place of the instruction set in use in the tables that HWY_EXPORT makes. The first place of
/// those tables holds what makes Highway's own choice; here it stands for the scalar kernels.
std::size_t dispatch_index() noexcept;
inline constexpr std::size_t kScalarIndex = 0;

/// The kernels of a room that are in use. table: made by HWY_EXPORT of a function that returns
/// them; where the compiler's options leave one instruction set alone, that is all it has.
template <typename Kernels, std::size_t kSize>
const Kernels& kernels_in_use(const Kernels& (*const (&table)[kSize])(),
                              const Kernels& (&scalar)()) noexcept {
    const std::size_t index = dispatch_index();
    if (index == kScalarIndex) return scalar();
    return table[kSize == 1 ? 0 : index]();
}

}  // namespace lightcull
