#pragma once

#include <lightcull/span.h>

#include <cstddef>

namespace lightcull {

/// A container's elements as they lie in memory.
template <typename Elements>
Span<const std::byte> bytes_of(const Elements& elements) noexcept {
    return {reinterpret_cast<const std::byte*>(elements.data()),
            elements.size() * sizeof(*elements.data())};
}

}  // namespace lightcull
