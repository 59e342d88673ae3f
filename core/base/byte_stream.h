#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

namespace lightcull {

/// Writes numbers one after the other, as they are in memory.
class ByteWriter {
  public:
    template <typename T>
    void write(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof value);
        std::memcpy(bytes_.data() + at, &value, sizeof value);
    }
    std::vector<std::uint8_t> take() noexcept { return std::move(bytes_); }

  private:
    std::vector<std::uint8_t> bytes_;
};

/// Reads what a ByteWriter has written.
class ByteReader {
  public:
    explicit ByteReader(Span<const std::uint8_t> bytes) noexcept : left_(bytes) {}

    /// Zero, and ok() false from then on, if there are not as many bytes any more.
    template <typename T>
    T read() noexcept {
        static_assert(std::is_trivially_copyable_v<T>);
        T value{};
        ok_ = ok_ && left_.size() >= sizeof value;
        if (!ok_) return value;
        std::memcpy(&value, left_.data(), sizeof value);
        left_ = {left_.data() + sizeof value, left_.size() - sizeof value};
        return value;
    }
    bool ok() const noexcept { return ok_; }
    std::size_t left() const noexcept { return left_.size(); }

  private:
    Span<const std::uint8_t> left_;
    bool ok_ = true;
};

}  // namespace lightcull
