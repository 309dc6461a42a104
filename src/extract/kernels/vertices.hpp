#pragma once
// Crossed edges -> vertices.
//
// The scan queues crossed edges, and their positions are computed some hundred at a time: so samples of the
// layer before, which have long left the caches, are on their way by then; the divisions come in vectors; and
// no loop is as short as a row has edges, for the processor guesses the end of short loops wrong.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

// Writes base + b for every set bit b of `bits`, in ascending order, and maybe some numbers behind them.
inline void write_bit_numbers(std::uint64_t bits, std::uint32_t base, std::uint32_t* out) {
#if defined(HYPERISO_AVX512)
  alignas(64) static constexpr auto numbers = [] {
    std::array<std::uint8_t, 64> all{};
    for (unsigned i = 0; i < 64; ++i) all[i] = static_cast<std::uint8_t>(i);
    return all;
  }();
  const __m512i found = _mm512_maskz_compress_epi8(bits, _mm512_load_si512(numbers.data()));
  const __m512i offset = _mm512_set1_epi32(static_cast<int>(base));
  _mm512_storeu_si512(out, _mm512_add_epi32(offset, _mm512_cvtepu8_epi32(_mm512_castsi512_si128(found))));
  const int count = std::popcount(bits);
  if (count <= 16) return;
  const auto write_next = [&](__m128i bytes, std::uint32_t* to) {
    _mm512_storeu_si512(to, _mm512_add_epi32(offset, _mm512_cvtepu8_epi32(bytes)));
  };
  write_next(_mm512_extracti32x4_epi32(found, 1), out + 16);
  if (count <= 32) return;
  write_next(_mm512_extracti32x4_epi32(found, 2), out + 32);
  write_next(_mm512_extracti32x4_epi32(found, 3), out + 48);
#else
  for (; bits != 0; out += 4)
    for (int i = 0; i < 4; ++i) {
      out[i] = base + static_cast<std::uint32_t>(std::countr_zero(bits));
      bits &= bits - 1;
    }
#endif
}

// What the crossed edges of one row and direction have in common.
template <int D, Method M>
struct EdgeGroup {
  RowPair rows; // sample i of `lower` and of `upper` are the ends of an edge; `lower` is shifted for that
  // Along an axis that moves, lower[0] is the coordinate of the lower end and lower[1] of the upper; along
  // axis 0, lower[at] and lower[at + 1]. By hull only one axis moves.
  std::array<const double*, M == Method::hull ? 1 : D> lower;
  std::uint32_t varies; // all bits where the edges run along axis 0, else none
  unsigned direction;
  std::size_t layer;      // index of the row along the last axis
  GridEdge edge;          // the number of the edge that would end at x = 0
  const std::byte* start; // position of the row's first sample, f32 or f64
};

template <int D, Method M>
class EdgeQueue {
 public:
  explicit EdgeQueue(const ScanJob<D>& job)
      : samples_(*job.samples), row_kernels_(*job.row_kernels), wide_(job.wide_positions),
        keep_edges_(job.keep_edges), first_row_(job.first_row) {
    const auto most_in_row = static_cast<std::size_t>(job.grid->dims[0]) * CellEdges<D, M>::directions;
    upper_.resize(enough + most_in_row + 64);
    group_.resize(upper_.size());
    lower_values_.resize(upper_.size());
    upper_values_.resize(upper_.size());
    for (unsigned number = 0; number < CellEdges<D, M>::directions; ++number) {
      const unsigned direction = CellEdges<D, M>::direction(number);
      std::int64_t samples_back = 0;
      for (int axis = 0; axis < D; ++axis)
        if (direction >> axis & 1) samples_back += samples_.strides[axis];
      bytes_back_[direction] = samples_back * static_cast<std::int64_t>(samples_.sample_size);
    }
  }

  std::size_t size() const { return count_; }
  bool has_enough() const { return count_ >= enough; }

  // The row that the following edges end in: its number, the index of its first sample, and that sample.
  void set_row(std::int64_t row, const std::array<std::int64_t, D>& index, const std::byte* samples) {
    row_ = first_row_ + row;
    layer_ = static_cast<std::size_t>(index[D - 1]);
    row_samples_ = samples;
    // A row without edges leaves its place to the next.
    if (group_count_ > 0 && groups_[group_count_ - 1].start == starts_[row_count_].data()) ++row_count_;
    for (int axis = 0; axis < D; ++axis) {
      here_[axis] = samples_.coordinates[axis].data() + index[axis];
      if (wide_)
        write_start(axis, *here_[axis]);
      else
        write_start(axis, static_cast<float>(*here_[axis]));
    }
  }
  // Adds the crossed edges whose upper ends are the set bits of word `word` of the row.
  void add(std::uint64_t bits, std::int64_t word) {
    if (bits == 0) return;
    const auto count = static_cast<std::size_t>(std::popcount(bits));
    write_bit_numbers(bits, static_cast<std::uint32_t>(64 * word), upper_.data() + count_);
    const auto group = static_cast<std::uint32_t>(group_count_);
    std::uint32_t* groups = group_.data() + count_;
    std::size_t i = 0;
    do // up to 16 without a branch
      for (std::size_t k = 0; k < 16; ++k) groups[i + k] = group;
    while ((i += 16) < count);
    count_ += count;
  }
  // Makes a group of those added since the last one. `far`: their lower ends are in memory that has not been
  // read for long.
  void end_group(unsigned direction, bool far) {
    if (count_ == grouped_) return;
    if (group_count_ == groups_.size()) groups_.resize(2 * groups_.size());
    EdgeGroup<D, M>& group = groups_[group_count_++];
    group.rows = {row_samples_ - bytes_back_[direction], row_samples_};
    group.varies = direction & 1 ? ~std::uint32_t{0} : 0;
    group.direction = direction;
    group.layer = layer_;
    group.edge = (static_cast<GridEdge>(row_) << D | direction) * static_cast<GridEdge>(samples_.dims[0]);
    group.start = starts_[row_count_].data();
    if constexpr (M == Method::hull)
      group.lower[0] = here_[std::countr_zero(direction)] - 1;
    else
      for (int axis = 0; axis < D; ++axis) group.lower[axis] = here_[axis] - 1;
    if (far) {
      const auto stride = samples_.strides[0] * static_cast<std::int64_t>(samples_.sample_size);
      for (std::size_t i = grouped_; i < count_; ++i)
        __builtin_prefetch(group.rows.lower + upper_[i] * stride);
    }
    grouped_ = count_;
  }

  // Appends their vertices to `batch` and empties the queue.
  void flush(VertexBatch& batch) {
    if (count_ == 0) return;
    make_room(batch, count_);
    compute_weights();
    if (wide_)
      write_positions(static_cast<double*>(batch.positions.data()) + batch.count * D);
    else
      write_positions(static_cast<float*>(batch.positions.data()) + batch.count * D);
    if (keep_edges_) {
      GridEdge* edges = batch.edges.data() + batch.count;
      for (std::size_t i = 0; i < count_; ++i) edges[i] = groups_[group_[i]].edge + upper_[i];
    }
    batch.count += count_;
    count_ = grouped_ = group_count_ = row_count_ = 0;
  }

 private:
  static constexpr std::size_t enough = 512;

  template <class Real>
  void write_start(int axis, Real coordinate) {
    std::memcpy(starts_[row_count_].data() + static_cast<std::size_t>(axis) * sizeof(Real), &coordinate,
                sizeof(Real));
  }

  void make_room(VertexBatch& batch, std::size_t more) const {
    if (batch.count + more <= batch.capacity) return;
    batch.capacity = std::max(2 * batch.capacity, batch.count + more);
    batch.positions.resize(batch.capacity * D * (wide_ ? sizeof(double) : sizeof(float)));
    if (keep_edges_) batch.edges.resize(batch.capacity);
  }

  // Where the surface crosses each edge, to upper_values_.
  void compute_weights() {
    double* a = lower_values_.data();
    double* b = upper_values_.data();
    row_kernels_.load(&groups_[0].rows, sizeof(EdgeGroup<D, M>), group_.data(), upper_.data(),
                      samples_.strides[0], count_, a, b);
    if (!samples_.levels.empty()) return compute_lifted_weights();
    const double isovalue = samples_.isovalue;
    // The formula of `crossing` where the difference is finite, as it always is but for infinite samples.
    bool finite = true;
    for (std::size_t i = 0; i < count_; ++i)
      finite &= std::abs(b[i] - a[i]) <= std::numeric_limits<double>::max();
    if (finite)
      for (std::size_t i = 0; i < count_; ++i) b[i] = (isovalue - a[i]) / (b[i] - a[i]);
    else
      for (std::size_t i = 0; i < count_; ++i) b[i] = crossing(a[i], b[i], isovalue);
  }

  // The same in a lifted field. Within a level it is the crossing of the field at that level, to the bit.
  void compute_lifted_weights() {
    for (std::size_t i = 0; i < count_; ++i) {
      const EdgeGroup<D, M>& group = groups_[group_[i]];
      const bool across = group.direction >> (D - 1) & 1;
      const double upper_level = samples_.levels[group.layer];
      const double lower_level = samples_.levels[group.layer - across];
      upper_values_[i] = across ? crossing(lower_values_[i] - lower_level, upper_values_[i] - upper_level, 0)
                                : crossing(lower_values_[i], upper_values_[i], upper_level);
    }
  }

  template <class Real>
  void write_positions(Real* position) const {
    const double* x = samples_.coordinates[0].data();
    const double* weight = upper_values_.data();
    for (std::size_t i = 0; i < count_; ++i, position += D) {
      const EdgeGroup<D, M>& group = groups_[group_[i]];
      const std::uint32_t at = upper_[i], start = at & group.varies;
      const auto along = [&](int axis, std::uint32_t offset) {
        const double* lower = group.lower[M == Method::hull ? 0 : axis] + offset;
        return static_cast<Real>(lower[0] + weight[i] * (lower[1] - lower[0]));
      };
      std::memcpy(position, group.start, D * sizeof(Real));
      if constexpr (M == Method::hull) {
        // One axis moves; where it is axis 0, the second line has the last word.
        const int axis = std::countr_zero(group.direction);
        position[0] = static_cast<Real>(x[at]);
        position[axis] = along(axis, start);
      } else {
        position[0] = group.direction & 1 ? along(0, at) : static_cast<Real>(x[at]);
        for (int axis = 1; axis < D; ++axis)
          if (group.direction >> axis & 1) position[axis] = along(axis, 0);
      }
    }
  }

  const Samples<D>& samples_;
  const RowKernels& row_kernels_;
  const bool wide_, keep_edges_;
  const std::int64_t first_row_;
  std::array<std::int64_t, 1 << D> bytes_back_{}; // from the upper to the lower end, by direction
  // Of the current row.
  std::int64_t row_ = 0;
  std::size_t layer_ = 0;
  const std::byte* row_samples_ = nullptr;
  std::array<const double*, D> here_{}; // coordinates of its first sample

  std::vector<EdgeGroup<D, M>> groups_{256};
  std::size_t group_count_ = 0;
  // Positions of the first samples of the rows that have groups, and of the current row. Not in the groups:
  // what was written in parts and is read as a whole at once makes the processor wait.
  std::vector<std::array<std::byte, D * sizeof(double)>> starts_{enough + 1};
  std::size_t row_count_ = 0;
  std::vector<std::uint32_t> upper_; // index along axis 0 of the upper end of each edge
  std::vector<std::uint32_t> group_; // of each edge
  std::vector<double> lower_values_, upper_values_;
  std::size_t count_ = 0, grouped_ = 0; // edges, and those of them that have a group
};

} // namespace
} // namespace hyperiso
