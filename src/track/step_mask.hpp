#pragma once
// Which samples of a step are inside, a bit each.

#include "extract/kernels.hpp"

namespace hyperiso::track_detail {

// Rows along axis 0, of whole words; the bits behind the last sample are 0.
class StepMask {
 public:
  template <class T, int S> // S: axes of space
  StepMask(const FieldView<const T, S>& step, double isovalue, Inside inside) {
    const auto dims = step.dims();
    const InsideTest test = inside_test<T>(isovalue, inside);
    const RowKernels kernels = row_kernels(sample_type_of<T>(), best_instructions());
    words_ = static_cast<std::size_t>((dims[0] + 63) / 64);
    for (int axis = 1; axis < S; ++axis) rows_ *= static_cast<std::size_t>(dims[axis]);
    bits_.resize(rows_ * words_);
    std::vector<T> gathered(step.strides[0] == 1 ? 0 : static_cast<std::size_t>(dims[0]));
    std::array<std::int64_t, S> index{};
    for (std::size_t row = 0; row < rows_; ++row) {
      const T* samples = &step.at(index);
      if (!gathered.empty()) {
        kernels.gather(reinterpret_cast<const std::byte*>(samples), step.strides[0], dims[0],
                       reinterpret_cast<std::byte*>(gathered.data()));
        samples = gathered.data();
      }
      has_missing_ |=
          kernels.inside(reinterpret_cast<const std::byte*>(samples), dims[0], test, &bits_[row * words_]);
      for (int axis = 1; axis < S && ++index[axis] == dims[axis]; ++axis) index[axis] = 0;
    }
  }

  bool has_missing() const { return has_missing_; }
  std::size_t rows() const { return rows_; }
  std::size_t words() const { return words_; } // of a row
  const std::uint64_t* row(std::size_t number) const { return &bits_[number * words_]; }
  bool inside(std::size_t row_number, std::size_t x) const { return row(row_number)[x / 64] >> (x % 64) & 1; }

 private:
  std::vector<std::uint64_t> bits_;
  std::size_t rows_ = 1, words_ = 0;
  bool has_missing_ = false;
};

} // namespace hyperiso::track_detail
