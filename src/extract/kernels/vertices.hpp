#pragma once
// Crossed edges -> vertices.
//
// The scan queues crossed edges, and their positions are computed some hundred at a time: so samples of the
// layer before, which have long left the caches, are on their way by then; the divisions come in vectors; and
// no loop is as short as a row has edges, for the processor guesses the end of short loops wrong.

#include "extract/kernels/words.hpp"

namespace hyperiso {
namespace {

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
  using Edges = CellEdges<D, M>;
  using Group = EdgeGroup<D, M>;

  EdgeQueue(const ScanJob<D>& job, ScanMemory& memory)
      : samples_(*job.samples), row_kernels_(*job.row_kernels), wide_(job.wide_positions),
        keep_edges_(job.keep_edges), first_row_(job.first_row) {
    memory.edge_upper.reset(most_edges);
    memory.edge_group.reset(most_edges);
    memory.lower_values.reset(most_edges);
    memory.upper_values.reset(most_edges);
    memory.groups.reset(most_rows * Edges::directions * sizeof(Group));
    memory.starts.reset(most_rows * sizeof(Start));
    upper_ = memory.edge_upper.data();
    group_ = memory.edge_group.data();
    lower_values_ = memory.lower_values.data();
    upper_values_ = memory.upper_values.data();
    groups_ = static_cast<Group*>(memory.groups.data());
    starts_ = static_cast<Start*>(memory.starts.data());
    const auto sample_size = static_cast<std::int64_t>(samples_.sample_size);
    for (unsigned number = 0; number < Edges::directions; ++number) {
      const unsigned direction = Edges::direction(number);
      std::int64_t samples_back = 0;
      for (int axis = 0; axis < D; ++axis)
        if (direction >> axis & 1) samples_back += samples_.strides[axis];
      bytes_back_[number] = samples_back * sample_size;
    }
    const std::int64_t layer_bytes = job.grid->dims[0] * job.grid->layer_rows * sample_size;
    far_ = layer_bytes > stays_in_cache ? 1u << (D - 1) : 0;
  }

  bool has_enough() const { return count_ >= enough; }
  // Whether so many rows more have room for their groups.
  bool has_room_for(std::size_t rows) const { return rows_ + rows <= most_rows; }

  // Adds a row that edges end in: its number, the index of its first sample, and that sample. Returns the
  // first of its groups, which are numbered like the directions.
  std::uint32_t add_row(std::int64_t row, const std::array<std::int64_t, D>& index,
                        const std::byte* samples) {
    std::array<const double*, D> here;
    for (int axis = 0; axis < D; ++axis) {
      here[axis] = samples_.coordinates[axis].data() + index[axis];
      if (wide_)
        write_start(axis, *here[axis]);
      else
        write_start(axis, static_cast<float>(*here[axis]));
    }
    const auto first = static_cast<std::uint32_t>(rows_ * Edges::directions);
    for (unsigned number = 0; number < Edges::directions; ++number) {
      const unsigned direction = Edges::direction(number);
      Group& group = groups_[first + number];
      group.rows = {samples - bytes_back_[number], samples};
      group.varies = direction & 1 ? ~std::uint32_t{0} : 0;
      group.direction = direction;
      group.layer = static_cast<std::size_t>(index[D - 1]);
      group.edge = (static_cast<GridEdge>(first_row_ + row) << D | direction) *
                   static_cast<GridEdge>(samples_.dims[0]);
      group.start = starts_[rows_].data();
      if constexpr (M == Method::hull)
        group.lower[0] = here[std::countr_zero(direction)] - 1;
      else
        for (int axis = 0; axis < D; ++axis) group.lower[axis] = here[axis] - 1;
    }
    ++rows_;
    return first;
  }
  // Adds the crossed edges of a group whose upper ends are the set bits of a word of its row.
  void add(std::uint64_t bits, std::int64_t word, std::uint32_t group) {
    const auto count = static_cast<std::size_t>(std::popcount(bits));
    std::uint32_t* upper = upper_ + count_;
    write_bit_numbers(bits, static_cast<std::uint32_t>(64 * word), upper);
    std::uint32_t* groups = group_ + count_;
    std::size_t i = 0;
    do // up to 16 without a branch
      for (std::size_t k = 0; k < 16; ++k) groups[i + k] = group;
    while ((i += 16) < count);
    if (groups_[group].direction & far_) prefetch_lower(groups_[group], upper, count);
    count_ += count;
  }

  // Appends their vertices to `batch` and empties the queue.
  void flush(VertexBatch& batch) {
    if (count_ > 0) compute(batch);
    count_ = 0;
  }
  // After that: forgets the rows.
  void forget_rows() { rows_ = 0; }

 private:
  static constexpr std::size_t enough = 512, most_edges = enough + 64 + 64;
  static constexpr std::size_t most_rows = 256;
  static constexpr std::int64_t stays_in_cache = 1 << 19; // bytes of a layer until the next one is read
  using Start = std::array<std::byte, D * sizeof(double)>;

  void compute(VertexBatch& batch) {
    make_room(batch, count_);
    compute_weights();
    if (wide_)
      write_positions(static_cast<double*>(batch.positions.data()) + batch.count * D);
    else
      write_positions(static_cast<float*>(batch.positions.data()) + batch.count * D);
    if (keep_edges_) {
      GridEdge* edges = batch.edges.data() + batch.count;
      const std::uint32_t *upper = upper_, *group = group_;
      for (std::size_t i = 0; i < count_; ++i) edges[i] = groups_[group[i]].edge + upper[i];
    }
    batch.count += count_;
  }

  template <class Real>
  void write_start(int axis, Real coordinate) {
    std::memcpy(starts_[rows_].data() + static_cast<std::size_t>(axis) * sizeof(Real), &coordinate,
                sizeof(Real));
  }

  // The lower ends are in memory that has not been read for long.
  void prefetch_lower(const Group& group, const std::uint32_t* upper, std::size_t count) const {
    const auto stride = samples_.strides[0] * static_cast<std::int64_t>(samples_.sample_size);
    std::size_t i = 0;
    do // four at a time: some numbers behind the last are harmless
      for (std::size_t k = 0; k < 4; ++k) __builtin_prefetch(group.rows.lower + upper[i + k] * stride);
    while ((i += 4) < count);
  }

  void make_room(VertexBatch& batch, std::size_t more) const {
    if (batch.count + more <= batch.capacity) return;
    batch.capacity = std::max(2 * batch.capacity, batch.count + more);
    batch.positions.resize(batch.capacity * D * (wide_ ? sizeof(double) : sizeof(float)));
    if (keep_edges_) batch.edges.resize(batch.capacity);
  }

  // Where the surface crosses each edge, to upper_values_.
  void compute_weights() {
    double* a = lower_values_;
    double* b = upper_values_;
    row_kernels_.load(&groups_[0].rows, sizeof(Group), group_, upper_, samples_.strides[0], count_, a, b);
    if (!samples_.levels.empty()) return compute_lifted_weights();
    const double isovalue = samples_.isovalue;
    // The formula of `crossing` where the difference is finite, as it always is but for infinite samples.
    std::uint64_t infinite = 0; // as wide as the samples, for vectors
    for (std::size_t i = 0; i < count_; ++i)
      infinite |= std::abs(b[i] - a[i]) <= std::numeric_limits<double>::max() ? 0 : 1;
    if (infinite == 0)
      for (std::size_t i = 0; i < count_; ++i) b[i] = (isovalue - a[i]) / (b[i] - a[i]);
    else
      for (std::size_t i = 0; i < count_; ++i) b[i] = crossing(a[i], b[i], isovalue);
  }

  // The same in a lifted field. Within a level it is the crossing of the field at that level, to the bit.
  void compute_lifted_weights() {
    for (std::size_t i = 0; i < count_; ++i) {
      const Group& group = groups_[group_[i]];
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
    const double* weight = upper_values_;
    // Positions are copied as bytes, so that the compiler takes them to change what is not in registers.
    const Group* groups = groups_;
    const std::uint32_t *uppers = upper_, *group_numbers = group_;
    for (std::size_t i = 0, count = count_; i < count; ++i, position += D) {
      const Group& group = groups[group_numbers[i]];
      const std::uint32_t at = uppers[i], start = at & group.varies;
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
  const std::int64_t first_row_;                             // of the job, in the whole field
  unsigned far_;                                             // directions of edges from far back in memory
  std::array<std::int64_t, Edges::directions> bytes_back_{}; // from the upper to the lower end

  Group* groups_;
  // Positions of the first samples of the rows. Not in the groups: what was written in parts and is read as a
  // whole at once makes the processor wait.
  Start* starts_;
  std::size_t rows_ = 0;
  std::uint32_t* upper_; // index along axis 0 of the upper end of each edge
  std::uint32_t* group_; // of each edge
  double *lower_values_, *upper_values_;
  std::size_t count_ = 0; // of edges
};

} // namespace
} // namespace hyperiso
