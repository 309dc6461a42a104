#pragma once
// Which samples of a step are inside, a bit each.

#include "core/parallel.hpp"
#include "extract/kernels.hpp"

namespace hyperiso::track_detail {

// Rows along axis 0, of whole words; the bits behind the last sample are 0.
class StepMask {
 public:
  // S: axes of space. Small steps are passed over by fewer than `threads`.
  template <class T, int S>
  StepMask(const FieldView<const T, S>& step, double isovalue, Inside inside, int threads = 1)
      : words_(static_cast<std::size_t>((step.dims()[0] + 63) / 64)) {
    for (int axis = 1; axis < S; ++axis) rows_ *= static_cast<std::size_t>(step.dims()[axis]);
    bits_.resize(rows_ * words_);
    uniform_.resize(rows_);
    constexpr std::int64_t worth_a_thread = 1 << 19; // samples
    const int workers = std::clamp(static_cast<int>(step.grid.samples() / worth_a_thread), 1, threads);
    std::vector<PlanePass<T, S>> passes(static_cast<std::size_t>(workers), {step, isovalue, inside});
    std::atomic<bool> has_missing = false;
    const auto plane_rows = static_cast<std::size_t>(step.dims()[1]);
    share_out(workers, rows_ / plane_rows, [&](int worker, std::size_t plane) {
      const std::size_t row = plane * plane_rows;
      if (passes[static_cast<std::size_t>(worker)].has_missing(plane, &bits_[row * words_], &uniform_[row]))
        has_missing = true;
    });
    has_missing_ = has_missing;
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
  // Passes over the rows of one index along all axes but 0 and 1.
  template <class T, int S>
  class PlanePass {
   public:
    PlanePass(const FieldView<const T, S>& step, double isovalue, Inside inside)
        : step_(step), test_(inside_test<T>(isovalue, inside)),
          kernels_(row_kernels(sample_type_of<T>(), best_instructions())),
          gathered_(step.strides[0] == 1 ? 0 : static_cast<std::size_t>(step.dims()[0] * step.dims()[1])) {}

    bool has_missing(std::size_t plane, std::uint64_t* bits, std::uint8_t* uniform) {
      const auto dims = step_.dims();
      std::array<std::int64_t, S> index{};
      auto rest = static_cast<std::int64_t>(plane);
      for (int axis = 2; axis < S; rest /= dims[axis++]) index[axis] = rest % dims[axis];
      SampleRows rows{reinterpret_cast<const std::byte*>(&step_.at(index)), dims[1],
                      step_.strides[1] * static_cast<std::int64_t>(sizeof(T)), dims[0]};
      if (!gathered_.empty()) {
        for (std::int64_t i = 0; i < dims[1]; ++i)
          kernels_.gather(rows.first + i * rows.bytes_apart, step_.strides[0], dims[0],
                          reinterpret_cast<std::byte*>(gathered_.data() + i * dims[0]));
        rows = {reinterpret_cast<const std::byte*>(gathered_.data()), dims[1],
                dims[0] * static_cast<std::int64_t>(sizeof(T)), dims[0]};
      }
      return kernels_.inside(rows, test_, bits, uniform);
    }

   private:
    const FieldView<const T, S>& step_;
    InsideTest test_;
    RowKernels kernels_;
    std::vector<T> gathered_;
  };

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
