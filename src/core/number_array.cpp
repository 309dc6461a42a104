#include "hyperiso/number_array.hpp"

#include <algorithm>
#include <cstring>
#if !defined(__wasm__)
#include <sys/mman.h>
#endif

namespace hyperiso {
namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  if (bytes > SIZE_MAX - unit) throw std::bad_alloc();
  return (bytes + unit - 1) / unit * unit;
}

#if defined(__wasm__) // has no pages to map

bool is_mapped(std::size_t) { return false; }
void* map(std::size_t) { throw std::bad_alloc(); }
void* map_file(int, std::size_t) { throw std::bad_alloc(); }
void unmap(void*, std::size_t) {}
bool move_pages(void*, void*, std::size_t) { return false; }

#else

// Large blocks come from mmap, aligned to huge pages and advised to use them; small ones from operator new.
bool is_mapped(std::size_t capacity) { return capacity >= 2 * huge_page; }

void* map(std::size_t capacity) {
  if (capacity > SIZE_MAX - huge_page) throw std::bad_alloc();
  const std::size_t length = capacity + huge_page;
  void* mapped = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  const auto start = reinterpret_cast<std::uintptr_t>(mapped);
  const auto aligned = (start + huge_page - 1) / huge_page * huge_page;
  if (aligned > start) munmap(mapped, aligned - start);
  munmap(reinterpret_cast<void*>(aligned + capacity), start + length - (aligned + capacity));
  void* data = reinterpret_cast<void*>(aligned);
#ifdef MADV_HUGEPAGE
  madvise(data, capacity, MADV_HUGEPAGE); // a hint: without it the buffer is merely slower to fill
#endif
  return data;
}

void* map_file(int descriptor, std::size_t bytes) {
  void* data = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE, descriptor, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  return data;
}

void unmap(void* data, std::size_t capacity) { munmap(data, capacity); }

// Pages of `from` become those of `to`, unread and uncopied; false if the system cannot do it.
bool move_pages([[maybe_unused]] void* from, [[maybe_unused]] void* to, [[maybe_unused]] std::size_t bytes) {
#ifdef MREMAP_FIXED
  return mremap(from, bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, to) != MAP_FAILED;
#else
  return false;
#endif
}

#endif

void* allocate(std::size_t capacity) {
  return is_mapped(capacity) ? map(capacity) : ::operator new (capacity, std::align_val_t{64});
}

// How many bytes to ask for where `bytes` are needed.
std::size_t capacity_for(std::size_t bytes) {
  return is_mapped(bytes) ? rounded_up(bytes, huge_page) : rounded_up(bytes, 64);
}

} // namespace

Buffer::Buffer(const Buffer& other) {
  reset(other.size_);
  if (size_ > 0) std::memcpy(data_, other.data_, size_);
}

Buffer::~Buffer() { release(); }

Buffer Buffer::of_file(int descriptor, std::size_t bytes) {
  Buffer buffer;
  if (bytes == 0) return buffer;
  buffer.data_ = map_file(descriptor, bytes);
  buffer.size_ = buffer.capacity_ = bytes;
  buffer.of_file_ = true;
  return buffer;
}

void Buffer::release() {
  if (data_ && (of_file_ || is_mapped(capacity_)))
    unmap(data_, capacity_);
  else if (data_)
    ::operator delete (data_, std::align_val_t{64});
  data_ = nullptr;
  size_ = capacity_ = 0;
  of_file_ = false;
}

void Buffer::reset(std::size_t bytes) {
  if (bytes > capacity_) {
    release();
    const std::size_t capacity = capacity_for(bytes);
    data_ = allocate(capacity);
    capacity_ = capacity;
  }
  size_ = bytes;
}

void Buffer::resize(std::size_t bytes) {
  if (bytes > capacity_) {
    const std::size_t capacity = capacity_for(std::max(bytes, capacity_ + capacity_ / 2));
    void* data = allocate(capacity);
    if (!of_file_ && is_mapped(capacity_) && move_pages(data_, data, capacity_))
      data_ = nullptr; // its pages are the new ones
    else if (data_)
      std::memcpy(data, data_, size_);
    release();
    data_ = data;
    capacity_ = capacity;
  }
  size_ = bytes;
}

} // namespace hyperiso
