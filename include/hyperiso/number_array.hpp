#pragma once
/// \file
/// Arrays whose element width is chosen at run time, in memory that can be reused.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <new>
#include <span>
#include <type_traits>
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
  /// The first `bytes` of an open file, read where they are looked at; changes stay in memory. The file may
  /// be closed. Throws std::bad_alloc.
  static Buffer of_file(int descriptor, std::size_t bytes);
  ~Buffer();

  /// Room for `bytes`, contents undefined. Keeps the memory it has if that is enough. Throws std::bad_alloc.
  void reset(std::size_t bytes);
  /// Room for `bytes`, keeping the contents as far as they fit. Growing in small steps costs amortised O(1)
  /// per byte; on Linux, large blocks move without being copied. Throws std::bad_alloc.
  void resize(std::size_t bytes);
  void* data() { return data_; }
  const void* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
    std::swap(of_file_, other.of_file_);
  }
  void release();
  void* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
  bool of_file_ = false;
};

/// An array in such memory: elements that nobody has set have undefined values.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;

  void reset(std::size_t size) { buffer_.reset(bytes_of(size)), size_ = size; }   ///< contents undefined
  void resize(std::size_t size) { buffer_.resize(bytes_of(size)), size_ = size; } ///< keeps the contents
  void clear() { size_ = 0; }
  /// The elements in `buffer`.
  void take(Buffer buffer) {
    buffer_ = std::move(buffer);
    size_ = buffer_.size() / sizeof(T);
  }
  void push_back(const T& value) {
    const T copy = value; // `value` may be an element
    resize(size_ + 1);
    data()[size_ - 1] = copy;
  }
  template <class Iterator>
  void assign(Iterator begin, Iterator end) {
    reset(static_cast<std::size_t>(std::distance(begin, end)));
    std::copy(begin, end, data());
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return static_cast<T*>(buffer_.data()); }
  const T* data() const { return static_cast<const T*>(buffer_.data()); }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  T& operator[](std::size_t i) { return data()[i]; }
  const T& operator[](std::size_t i) const { return data()[i]; }
  friend bool operator==(const Array& a, const Array& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  static std::size_t bytes_of(std::size_t size) {
    if (size > SIZE_MAX / sizeof(T)) throw std::bad_alloc();
    return size * sizeof(T);
  }
  Buffer buffer_;
  std::size_t size_ = 0;
};

/// An array of `Narrow` or of `Wide`; reads as `Wide` whichever it is.
template <class Narrow, class Wide>
class NumberArray {
 public:
  using NarrowType = Narrow;
  using WideType = Wide;

  /// `size` elements of undefined value; keeps the memory it has if that is enough. Throws std::bad_alloc.
  void reset(std::size_t size, bool wide) {
    buffer_.reset(bytes_of(size, wide));
    size_ = size;
    wide_ = wide;
  }
  /// `size` elements, the first of them kept; of the same width. Throws std::bad_alloc.
  void resize(std::size_t size) {
    buffer_.resize(bytes_of(size, wide_));
    size_ = size;
  }
  /// The elements in `buffer`.
  void take(Buffer buffer, bool wide) {
    buffer_ = std::move(buffer);
    wide_ = wide;
    size_ = buffer_.size() / (wide ? sizeof(Wide) : sizeof(Narrow));
  }
  std::size_t size() const { return size_; }
  bool wide() const { return wide_; }
  const void* data() const { return buffer_.data(); }
  void* data() { return buffer_.data(); }
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
  static std::size_t bytes_of(std::size_t size, bool wide) {
    const std::size_t width = wide ? sizeof(Wide) : sizeof(Narrow);
    if (size > SIZE_MAX / width) throw std::bad_alloc();
    return size * width;
  }
  Buffer buffer_;
  std::size_t size_ = 0;
  bool wide_ = false;
};

using PositionArray = NumberArray<float, double>;
using IndexArray = NumberArray<std::uint32_t, std::uint64_t>;

} // namespace hyperiso
