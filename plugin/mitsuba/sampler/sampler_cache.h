#pragma once

#include <memory>
#include <mutex>
#include <utility>

namespace mitsuba::culling {

/// One of a thing that is dear to make, kept by the last user for the next. Any number of threads.
template <typename T>
class Spare {
  public:
    /// Null if there is none, or someone else has it.
    std::unique_ptr<T> take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return std::move(thing_);
    }
    void keep(std::unique_ptr<T> thing) {
        const std::lock_guard<std::mutex> lock(mutex_);
        thing_ = std::move(thing);
    }

  private:
    std::mutex mutex_;
    std::unique_ptr<T> thing_;
};

}  // namespace mitsuba::culling
