#pragma once
// What extractions leave to each other.

#include "extract/kernels.hpp"

#include <memory>
#include <utility>

namespace hyperiso {

// Of any kind: extractions that need the same kind use it again.
struct Workspace::State {
  struct Memory {
    virtual ~Memory() = default;
  };
  std::unique_ptr<Memory> memory;

  // The memory if it is of type M, or else a new one in its place.
  template <class M>
  M& of_type() {
    if (auto* same = dynamic_cast<M*>(memory.get())) return *same;
    auto made = std::make_unique<M>();
    M& result = *made;
    memory = std::move(made);
    return result;
  }
};

struct FieldRanges::State {
  const std::byte* first = nullptr;
  SampleType type{};
  std::vector<std::int64_t> dims, strides;
  bool complete = false;
  Buffer low, high; // samples, for each word of each row's mask; NaN if one of the samples is

  // Whether they are those of `samples`. If not, makes room for them.
  template <int D>
  bool hold(const Samples<D>& samples) {
    const std::vector<std::int64_t> its_dims(samples.dims.begin(), samples.dims.end()),
        its_strides(samples.strides.begin(), samples.strides.end());
    if (complete && first == samples.first && type == samples.test.type && dims == its_dims &&
        strides == its_strides)
      return true;
    complete = false;
    const RowGrid<D> grid(samples.dims);
    const std::size_t bytes = static_cast<std::size_t>(grid.rows * grid.words) * samples.sample_size;
    low.reset(bytes), high.reset(bytes);
    first = samples.first, type = samples.test.type, dims = its_dims, strides = its_strides;
    return false;
  }
};

} // namespace hyperiso
