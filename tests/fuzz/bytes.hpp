#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

namespace meltscope::fuzz {

/// Decisions taken from an input; zeros once it is used up.
class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

    bool empty() const { return size_ == 0; }

    std::uint8_t byte() { return number<std::uint8_t>(); }

    template <class Number>
    Number number() {
        Number value{};
        const std::size_t count = std::min(sizeof value, size_);
        std::memcpy(&value, data_, count);
        drop(count);
        return value;
    }

    /// A text that ends at a zero or with the input.
    std::string text() {
        const auto* end = std::find(data_, data_ + size_, std::uint8_t(0));
        std::string result(data_, end);
        drop(std::min(result.size() + 1, size_));
        return result;
    }

  private:
    void drop(std::size_t count) {
        data_ += count;
        size_ -= count;
    }

    const std::uint8_t* data_;
    std::size_t size_;
};

} // namespace meltscope::fuzz
