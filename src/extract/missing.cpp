#include "extract/missing.hpp"

#include "core/parallel.hpp"

namespace hyperiso {
namespace {

// Calls use(index of the row's first sample, row) for every row, shared out among the workers.
template <int D, class Use>
void for_each_row(const RowGrid<D>& grid, int workers, Use&& use) {
  constexpr std::int64_t block_rows = 256;
  const auto blocks = static_cast<std::size_t>((grid.rows + block_rows - 1) / block_rows);
  share_out(workers, blocks, [&](int, std::size_t block) {
    const std::int64_t first = static_cast<std::int64_t>(block) * block_rows;
    for (std::int64_t row = first; row < std::min(first + block_rows, grid.rows); ++row) {
      std::array<std::int64_t, D> index{};
      std::int64_t rest = row;
      for (int axis = 1; axis < D; ++axis) {
        index[axis] = rest % grid.dims[axis];
        rest /= grid.dims[axis];
      }
      use(index, row);
    }
  });
}

template <int D>
Array<std::uint64_t> find_present_samples(const Samples<D>& samples, const RowGrid<D>& grid,
                                          const RowKernels& kernels, int workers) {
  Array<std::uint64_t> words;
  words.reset(static_cast<std::size_t>(grid.rows * grid.words));
  for_each_row(grid, workers, [&](const std::array<std::int64_t, D>& index, std::int64_t row) {
    const std::byte* first = samples.at(index);
    std::vector<std::byte> gathered;
    if (samples.strides[0] != 1) {
      gathered.resize(static_cast<std::size_t>(grid.dims[0]) * samples.sample_size);
      kernels.gather(first, samples.strides[0], grid.dims[0], gathered.data());
      first = gathered.data();
    }
    kernels.present(first, grid.dims[0], words.data() + row * grid.words);
  });
  return words;
}

} // namespace

template <int D>
PresentCells find_present_cells(const Samples<D>& samples, const RowGrid<D>& grid, const RowKernels& kernels,
                                int workers) {
  const Array<std::uint64_t> present = find_present_samples(samples, grid, kernels, workers);
  PresentCells cells;
  cells.words.reset(present.size());
  for_each_row(grid, workers, [&](const std::array<std::int64_t, D>& index, std::int64_t row) {
    std::uint64_t* row_cells = cells.words.data() + row * grid.words;
    bool last = false; // along some axis: no cell starts here
    for (int axis = 1; axis < D; ++axis) last |= index[axis] == grid.dims[axis] - 1;
    std::fill_n(row_cells, grid.words, last ? 0 : ~std::uint64_t{0});
    if (last) return;
    constexpr unsigned top = (1u << (D - 1)) - 1;
    for (unsigned place = 0; place <= top; ++place) {
      const std::uint64_t* samples_present =
          present.data() + (row + grid.rows_before_top(top ^ place)) * grid.words;
      for (std::int64_t word = 0; word < grid.words; ++word) {
        const std::uint64_t next = word + 1 < grid.words ? samples_present[word + 1] : 0;
        row_cells[word] &= samples_present[word] & (samples_present[word] >> 1 | next << 63);
      }
    }
  });
  return cells;
}

template PresentCells find_present_cells(const Samples<2>&, const RowGrid<2>&, const RowKernels&, int);
template PresentCells find_present_cells(const Samples<3>&, const RowGrid<3>&, const RowKernels&, int);
template PresentCells find_present_cells(const Samples<4>&, const RowGrid<4>&, const RowKernels&, int);
template PresentCells find_present_cells(const Samples<5>&, const RowGrid<5>&, const RowKernels&, int);

} // namespace hyperiso
