#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace lightcull {

/// Elements that copies of the array share until one of them is changed. They are read as fast as
/// those of a vector.
template <typename T>
class SharedArray {
  public:
    SharedArray() : elements_(std::make_shared<std::vector<T>>()) {}

    const T& operator[](std::size_t i) const noexcept { return data_[i]; }
    const T* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    const T* begin() const noexcept { return data_; }
    const T* end() const noexcept { return data_ + size_; }

    /// Calls change(std::vector<T>&) on the elements, which are copied before that if others share
    /// them.
    template <typename Change>
    void change(const Change& change) {
        if (is_shared()) elements_ = std::make_shared<std::vector<T>>(*elements_);
        const Refresh after{*this};
        change(*elements_);
    }

    bool is_shared() const noexcept { return elements_.use_count() > 1; }
    std::size_t memory_size() const noexcept { return size_ * sizeof(T); }

  private:
    /// Finds the elements again, even if a change throws.
    struct Refresh {
        SharedArray& array;
        ~Refresh() {
            array.data_ = array.elements_->data();
            array.size_ = array.elements_->size();
        }
    };

    std::shared_ptr<std::vector<T>> elements_;
    const T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace lightcull
