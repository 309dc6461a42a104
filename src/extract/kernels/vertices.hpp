#pragma once
// Crossed edges -> vertices.
//
// The scan queues the crossed edges of some rows before their positions are computed, so that samples of the
// layer before, which have long left the caches, are on their way by then; and so that the divisions come in
// vectors.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

// Crossed edges of one row and direction, in ascending order.
template <int D>
struct EdgeGroup {
  std::uint32_t first, end; // in EdgeQueue::upper
  unsigned direction;
  std::int64_t row;
  std::array<std::int64_t, D> upper; // index of the row's first sample
  const std::byte* upper_row;
  const std::byte* lower_row; // shifted: sample upper[i] of it is the edge's lower end
};

template <int D, Method M>
class EdgeQueue {
 public:
  explicit EdgeQueue(const ScanJob<D>& job)
      : samples_(*job.samples), row_kernels_(*job.row_kernels), wide_(job.wide_positions),
        keep_edges_(job.keep_edges) {
    const auto most_in_row = static_cast<std::size_t>(job.grid->dims[0]) * CellEdges<D, M>::directions;
    upper_.resize(enough + most_in_row + 4);
    lower_values_.resize(upper_.size());
    upper_values_.resize(upper_.size());
    groups_.reserve(enough);
  }

  std::size_t size() const { return count_; }
  bool has_enough() const { return count_ >= enough; }

  // Opens a group that the following words belong to.
  void begin_group(const EdgeGroup<D>& group) {
    groups_.push_back(group);
    groups_.back().first = static_cast<std::uint32_t>(count_);
  }
  // Adds the crossed edges whose upper ends are the set bits of word `word` of the row.
  void add(std::uint64_t bits, std::int64_t word) {
    const auto base = static_cast<std::uint32_t>(64 * word);
    std::uint32_t* out = upper_.data() + count_;
    count_ += static_cast<std::size_t>(std::popcount(bits));
    for (; bits != 0; out += 4)
      for (int i = 0; i < 4; ++i) { // up to three too many, which the next ones overwrite
        out[i] = base + static_cast<std::uint32_t>(std::countr_zero(bits));
        bits &= bits - 1;
      }
  }
  // Closes it. `far`: its lower samples are in memory that has not been read for long.
  void end_group(bool far) {
    EdgeGroup<D>& group = groups_.back();
    group.end = static_cast<std::uint32_t>(count_);
    if (group.end == group.first) return groups_.pop_back();
    if (!far) return;
    const auto stride = samples_.strides[0] * static_cast<std::int64_t>(samples_.sample_size);
    for (std::uint32_t i = group.first; i < group.end; ++i)
      __builtin_prefetch(group.lower_row + upper_[i] * stride);
  }

  // Appends their vertices to `batch` and empties the queue.
  void flush(VertexBatch& batch) {
    if (count_ == 0) return;
    make_room(batch, count_);
    compute_weights();
    for (const EdgeGroup<D>& group : groups_)
      if (wide_)
        write_positions(group,
                        static_cast<double*>(batch.positions.data()) + (batch.count + group.first) * D);
      else
        write_positions(group, static_cast<float*>(batch.positions.data()) + (batch.count + group.first) * D);
    if (keep_edges_)
      for (const EdgeGroup<D>& group : groups_)
        write_edges(group, batch.edges.data() + batch.count + group.first);
    batch.count += count_;
    groups_.clear();
    count_ = 0;
  }

 private:
  static constexpr std::size_t enough = 512;

  void make_room(VertexBatch& batch, std::size_t more) const {
    if (batch.count + more <= batch.capacity) return;
    batch.capacity = std::max(2 * batch.capacity, batch.count + more);
    batch.positions.resize(batch.capacity * D * (wide_ ? sizeof(double) : sizeof(float)));
    if (keep_edges_) batch.edges.resize(batch.capacity);
  }

  // Where the surface crosses each edge, to upper_values_.
  void compute_weights() {
    for (const EdgeGroup<D>& group : groups_) {
      const std::size_t edges = group.end - group.first;
      row_kernels_.load(group.lower_row, samples_.strides[0], &upper_[group.first], edges,
                        &lower_values_[group.first]);
      row_kernels_.load(group.upper_row, samples_.strides[0], &upper_[group.first], edges,
                        &upper_values_[group.first]);
    }
    if (!samples_.levels.empty()) return compute_lifted_weights();
    double* a = lower_values_.data();
    double* b = upper_values_.data();
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
    for (const EdgeGroup<D>& group : groups_) {
      const auto layer = static_cast<std::size_t>(group.upper[D - 1]);
      const bool across = group.direction >> (D - 1) & 1;
      const double upper_level = samples_.levels[layer], lower_level = samples_.levels[layer - across];
      for (std::uint32_t i = group.first; i < group.end; ++i)
        upper_values_[i] = across
                               ? crossing(lower_values_[i] - lower_level, upper_values_[i] - upper_level, 0)
                               : crossing(lower_values_[i], upper_values_[i], upper_level);
    }
  }

  template <class Real>
  void write_positions(const EdgeGroup<D>& group, Real* position) const {
    const unsigned direction = group.direction;
    const std::uint32_t* upper = &upper_[group.first];
    const double* weight = &upper_values_[group.first];
    const std::size_t edges = group.end - group.first;
    const double* x = samples_.coordinates[0].data();

    std::array<Real, D> start{}; // of the row's edges: their lower ends
    std::array<double, D> lower{}, step{};
    std::array<int, D> moving{}; // axes but 0 along which the edges run
    int movings = 0;
    for (int axis = 1; axis < D; ++axis) {
      const std::int64_t index = group.upper[axis];
      const bool moves = direction >> axis & 1;
      lower[axis] = samples_.coordinates[axis][static_cast<std::size_t>(index - moves)];
      start[axis] = static_cast<Real>(lower[axis]);
      if (!moves) continue;
      step[axis] = samples_.coordinates[axis][static_cast<std::size_t>(index)] - lower[axis];
      moving[movings++] = axis;
    }
    if constexpr (M == Method::hull) movings = direction == 1 ? 0 : 1;

    for (std::size_t i = 0; i < edges; ++i, position += D) {
      std::memcpy(position, start.data(), sizeof start);
      const std::uint32_t at = upper[i];
      position[0] = static_cast<Real>(direction & 1 ? x[at - 1] + weight[i] * (x[at] - x[at - 1]) : x[at]);
      for (int k = 0; k < movings; ++k)
        position[moving[k]] = static_cast<Real>(lower[moving[k]] + weight[i] * step[moving[k]]);
    }
  }

  void write_edges(const EdgeGroup<D>& group, GridEdge* edges) const {
    const GridEdge row =
        (static_cast<GridEdge>(group.row) << D | group.direction) * static_cast<GridEdge>(samples_.dims[0]);
    for (std::uint32_t i = group.first; i < group.end; ++i) *edges++ = row + upper_[i];
  }

  const Samples<D>& samples_;
  const RowKernels& row_kernels_;
  const bool wide_, keep_edges_;
  std::vector<EdgeGroup<D>> groups_;
  std::vector<std::uint32_t> upper_; // index along axis 0 of the upper end of each edge
  std::vector<double> lower_values_, upper_values_;
  std::size_t count_ = 0;
};

} // namespace
} // namespace hyperiso
