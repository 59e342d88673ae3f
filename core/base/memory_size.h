#pragma once

#include <cstddef>
#include <vector>

namespace lightcull {

/// The bytes of a vector's elements.
template <typename T>
std::size_t size_of(const std::vector<T>& vector) noexcept {
    return vector.size() * sizeof(T);
}

}  // namespace lightcull
