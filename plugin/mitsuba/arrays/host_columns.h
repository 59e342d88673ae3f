#pragma once

#include <lightcull/float3.h>

#include <drjit/array.h>
#include <drjit/dynamic.h>
#include <drjit/jit.h>
#include <nanothread/nanothread.h>

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace mitsuba::culling {

namespace dr = drjit;

/// A column gives the processor the elements of a Dr.Jit array. An array of a single element stands
/// for any number of it.
template <typename T>
class Column {
  public:
    template <typename Array>
    explicit Column(const Array& array) {
        auto values = std::make_shared<std::decay_t<decltype(dr::detach(array))>>(array);
        data_ = static_cast<const T*>(values->data());
        dr::sync_thread();  // a kernel may not have written them yet
        size_ = dr::width(*values);
        stride_ = size_ == 1 ? 0 : 1;
        keep_ = std::move(values);
    }
    T operator[](std::size_t i) const { return data_[i * stride_]; }
    std::size_t size() const { return size_; }

  private:
    std::shared_ptr<void> keep_;
    const T* data_;
    std::size_t size_, stride_;
};

/// A vector column does the same for an array of vectors.
class VectorColumn {
  public:
    template <typename Vector>
    explicit VectorColumn(const Vector& v) : x_(v.x()), y_(v.y()), z_(v.z()) {}
    ::lightcull::float3 operator[](std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

  private:
    Column<float> x_, y_, z_;
};

/// A shared array is memory that the processor writes and Dr.Jit reads as an array. Dr.Jit works in
/// packets: it reads, though it does not use, some elements after the last.
template <typename T>
class SharedArray {
  public:
    /// Makes the array `count` elements of `value`; what was there is lost.
    void assign(std::size_t count, T value) { values_.assign(count + kPadding, value); }
    T& operator[](std::size_t i) { return values_[i]; }

    /// The Dr.Jit array that reads this memory. It is no copy: the memory must stay as it is until
    /// all that uses the array has been evaluated.
    template <typename Array>
    Array view() {
        return dr::map<Array>(values_.data(), values_.size() - kPadding);
    }

  private:
    static constexpr std::size_t kPadding = 64;
    std::vector<T> values_;
};

/// Calls function(i) for each i below `count`, on Mitsuba's threads.
template <typename Function>
void for_each_lane(std::size_t count, const Function& function) {
    constexpr std::size_t kGrain = 4096;
    dr::parallel_for(dr::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) function(i);
    });
}

}  // namespace mitsuba::culling
