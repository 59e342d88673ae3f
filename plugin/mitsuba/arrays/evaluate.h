#pragma once

#include <drjit/array.h>
#include <drjit/dynamic.h>
#include <drjit/jit.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "arrays/host_columns.h"

namespace mitsuba::culling {

namespace dr = drjit;

/// The number as a Float of the variant.
template <typename Float, typename UInt32>
Float to_float(const UInt32& value) {
    if constexpr (dr::is_jit_v<Float>) {
        return Float(value);
    } else {
        return static_cast<Float>(value);
    }
}

/// The first `count` elements of a Dr.Jit array, copied; a single element stands for all.
template <typename T, typename Array>
std::vector<T> to_host(const Array& array, std::size_t count) {
    const Column<T> column(array);
    std::vector<T> elements(count);
    for (std::size_t i = 0; i < count; ++i) elements[i] = column[i];
    return elements;
}

/// Numbers of the processor's, of which each lane takes one.
template <typename Number>
class Lookup {
  public:
    using Numbers = std::vector<dr::scalar_t<Number>>;
    using UInt32 = dr::uint32_array_t<Number>;

    explicit Lookup(const Numbers& numbers) {
        if constexpr (dr::is_jit_v<Number>) {
            numbers_ = dr::load<Number>(numbers.data(), numbers.size());
            dr::sync_thread();  // the vector must live until it is copied
        } else {
            numbers_ = numbers;
        }
    }
    Number operator[](const UInt32& index) const {
        if constexpr (dr::is_jit_v<Number>) {
            return dr::gather<Number>(numbers_, index);
        } else {
            return numbers_[index];
        }
    }

  private:
    std::conditional_t<dr::is_jit_v<Number>, Number, Numbers> numbers_;
};

/// The values of value(i) for each i below `count`, where `value` gives N floats. `value` is called
/// on one array of all i in JIT variants, and once for each i in the others, on Mitsuba's threads.
template <std::size_t N, typename Float, typename Value>
std::array<std::vector<float>, N> evaluate(std::uint32_t count, Value&& value) {
    using UInt32 = dr::uint32_array_t<Float>;
    std::array<std::vector<float>, N> result;
    if constexpr (dr::is_jit_v<Float>) {
        std::array<Float, N> values = value(dr::arange<UInt32>(count));
        for (Float& v : values) dr::schedule(v);
        dr::eval();
        for (std::size_t k = 0; k < N; ++k) result[k] = to_host<float>(values[k], count);
    } else {
        for (auto& column : result) column.resize(count);
        for_each_lane(count, [&](std::size_t i) {
            const std::array<Float, N> values = value(static_cast<UInt32>(i));
            for (std::size_t k = 0; k < N; ++k) result[k][i] = values[k];
        });
    }
    return result;
}

}  // namespace mitsuba::culling
