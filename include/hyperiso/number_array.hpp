#pragma once
/// \file
/// Arrays whose element width is chosen at run time, in memory that can be reused.

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <utility>

namespace hyperiso {

/// Uninitialised memory, aligned for streaming stores and, where the system allows it, on huge pages: on a
/// large output, clearing fresh pages costs more than filling them.
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Buffer& other);
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer other) noexcept { return swap(other), *this; }
  ~Buffer();

  /// Room for `bytes`, contents undefined. Keeps the memory it has if that is enough. Throws std::bad_alloc.
  void reset(std::size_t bytes);
  void* data() { return data_; }
  const void* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }
  void* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// An array of `Narrow` or of `Wide`; reads as `Wide` whichever it is.
template <class Narrow, class Wide>
class NumberArray {
 public:
  using NarrowType = Narrow;
  using WideType = Wide;

  /// `size` elements of undefined value; keeps the memory it has if that is enough. Throws std::bad_alloc.
  void reset(std::size_t size, bool wide) {
    const std::size_t width = wide ? sizeof(Wide) : sizeof(Narrow);
    if (size > SIZE_MAX / width) throw std::bad_alloc();
    buffer_.reset(size * width);
    size_ = size;
    wide_ = wide;
  }
  std::size_t size() const { return size_; }
  bool wide() const { return wide_; }
  const void* data() const { return buffer_.data(); }
  std::size_t bytes() const { return size_ * (wide_ ? sizeof(Wide) : sizeof(Narrow)); }

  Wide operator[](std::size_t i) const {
    return wide_ ? static_cast<const Wide*>(buffer_.data())[i]
                 : static_cast<Wide>(static_cast<const Narrow*>(buffer_.data())[i]);
  }
  void set(std::size_t i, Wide value) {
    if (wide_)
      static_cast<Wide*>(buffer_.data())[i] = value;
    else
      static_cast<Narrow*>(buffer_.data())[i] = static_cast<Narrow>(value);
  }

  /// Calls `use` with a std::span of the elements as they are stored.
  template <class Use>
  decltype(auto) visit(Use&& use) {
    return wide_ ? use(std::span(static_cast<Wide*>(buffer_.data()), size_))
                 : use(std::span(static_cast<Narrow*>(buffer_.data()), size_));
  }
  template <class Use>
  decltype(auto) visit(Use&& use) const {
    return wide_ ? use(std::span(static_cast<const Wide*>(buffer_.data()), size_))
                 : use(std::span(static_cast<const Narrow*>(buffer_.data()), size_));
  }

 private:
  Buffer buffer_;
  std::size_t size_ = 0;
  bool wide_ = false;
};

using PositionArray = NumberArray<float, double>;
using IndexArray = NumberArray<std::uint32_t, std::uint64_t>;

} // namespace hyperiso
