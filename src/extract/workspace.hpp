#pragma once
// What extractions leave to each other.

#include "extract/kernels.hpp"

#include <memory>

namespace hyperiso {

// Of fields of any dimension: extractions of the same dimension use it again.
struct Workspace::State {
  struct Memory {
    virtual ~Memory() = default;
  };
  std::unique_ptr<Memory> memory;
  int dimension = 0; // whose it is

  // That of dimension D: the memory there is, or a new one in its place.
  template <int D, class DimensionMemory>
  DimensionMemory& of_dimension() {
    if (!memory || dimension != D) {
      memory = std::make_unique<DimensionMemory>();
      dimension = D;
    }
    return static_cast<DimensionMemory&>(*memory);
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
