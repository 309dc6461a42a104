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
    uniform_.resize(rows_);
    const auto plane_rows = static_cast<std::size_t>(dims[1]);
    std::vector<T> gathered(step.strides[0] == 1 ? 0 : static_cast<std::size_t>(dims[0] * dims[1]));
    std::array<std::int64_t, S> index{};
    for (std::size_t row = 0; row < rows_;
         row += plane_rows) { // rows of one index along all axes but 0 and 1
      SampleRows rows{reinterpret_cast<const std::byte*>(&step.at(index)), dims[1],
                      step.strides[1] * static_cast<std::int64_t>(sizeof(T)), dims[0]};
      if (!gathered.empty()) {
        for (std::int64_t i = 0; i < dims[1]; ++i)
          kernels.gather(rows.first + i * rows.bytes_apart, step.strides[0], dims[0],
                         reinterpret_cast<std::byte*>(gathered.data() + i * dims[0]));
        rows = {reinterpret_cast<const std::byte*>(gathered.data()), dims[1],
                dims[0] * static_cast<std::int64_t>(sizeof(T)), dims[0]};
      }
      has_missing_ |= kernels.inside(rows, test, &bits_[row * words_], &uniform_[row]);
      for (int axis = 2; axis < S && ++index[axis] == dims[axis]; ++axis) index[axis] = 0;
    }
  }

  bool has_missing() const { return has_missing_; }
  std::size_t rows() const { return rows_; }
  std::size_t words() const { return words_; } // of a row
  // 0 if no sample of the row is inside, 255 if all are, 1 otherwise.
  std::uint8_t uniform(std::size_t number) const { return uniform_[number]; }
  const std::uint64_t* row(std::size_t number) const { return &bits_[number * words_]; }
  const std::uint8_t* uniform() const { return uniform_.data(); } // of all rows
  bool inside(std::size_t row_number, std::size_t x) const { return row(row_number)[x / 64] >> (x % 64) & 1; }

 private:
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint8_t> uniform_;
  std::size_t rows_ = 1, words_ = 0;
  bool has_missing_ = false;
};

// The bits of a sample of a row and of the one behind it.
inline unsigned pair_at(const std::uint64_t* row, std::size_t x) {
  const std::uint64_t low = row[x / 64] >> (x % 64);
  return static_cast<unsigned>((x % 64 == 63 ? low | row[x / 64 + 1] << 1 : low) & 3);
}

} // namespace hyperiso::track_detail
