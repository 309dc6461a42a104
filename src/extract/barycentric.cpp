#include "extract/barycentric.hpp"

#include "core/cell.hpp"
#include "core/sign.hpp"
#include "extract/kernels.hpp"
#include "extract/reference.hpp"
#include "extract/surface_memory.hpp"
#include "table/midpoint_cut.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <unordered_map>

namespace hyperiso {
namespace {

// Points of a cell: its corners and the centres of its faces, by coordinates 0, 1, 2 along each axis, of
// which 1 is the middle; numbered in base 3, axis 0 first.
template <int D>
constexpr unsigned cell_points = 3 * cell_points<D - 1>;
template <>
constexpr unsigned cell_points<0> = 1;

// A simplex of the subdivision: the ends of an edge, the centre of a square that it bounds, of a cube that
// this bounds, and so on up to the cell. This is also the order in which its corners are cut: by dimension,
// then by position, the same for all cells.
template <int D>
struct Flag {
  std::array<unsigned, D + 1> points;
  bool positive; // orientation, for axes that all increase
};

// All 2^(D-1) D! of them.
template <int D>
std::vector<Flag<D>> flags() {
  std::array<unsigned, D> place; // of an axis in base 3
  for (unsigned axis = 0, power = 1; axis < D; ++axis, power *= 3) place[axis] = power;
  std::vector<Flag<D>> found;
  std::array<unsigned, D> axes;
  std::iota(axes.begin(), axes.end(), 0);
  do {
    unsigned inversions = 0;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < i; ++j) inversions += axes[j] > axes[i];
    for (unsigned lower = 0; lower < 1u << D; ++lower) {
      if (lower >> axes[0] & 1) continue;
      Flag<D> flag{{}, (inversions + static_cast<unsigned>(std::popcount(lower))) % 2 == 0};
      unsigned point = 0;
      for (unsigned axis = 0; axis < D; ++axis) point += (lower >> axis & 1) * 2 * place[axis];
      flag.points[0] = point;
      flag.points[1] = point + 2 * place[axes[0]];
      point += place[axes[0]];
      for (unsigned k = 1; k < D; ++k) {
        point = lower >> axes[k] & 1 ? point - place[axes[k]] : point + place[axes[k]];
        flag.points[k + 1] = point;
      }
      found.push_back(flag);
    }
  } while (std::ranges::next_permutation(axes).found);
  return found;
}

// For each way to label the corners of a simplex, the simplices of the cut; a vertex by the corners of the
// face that it belongs to.
template <int D>
std::vector<std::vector<typename MidpointCut<D>::Simplex>> cuts(Cut cut) {
  std::vector<std::vector<typename MidpointCut<D>::Simplex>> simplices(1u << (D + 1));
  for (unsigned positive = 0; positive < simplices.size(); ++positive)
    if (cut == Cut::midpoints) {
      const auto all = midpoint_cut<D>().simplices(positive);
      simplices[positive].assign(all.begin(), all.end());
    } else {
      for (const auto& simplex : simplex_cut<D>().simplices(positive)) {
        auto& sets = simplices[positive].emplace_back();
        std::ranges::transform(simplex, sets.begin(), [](CornerPair pair) {
          return static_cast<std::uint8_t>(1u << pair.lower | 1u << pair.upper);
        });
      }
    }
  return simplices;
}

// The points that span the face of the subdivision which a vertex belongs to, as numbers in the grid of all
// points; unused places are `none`. What makes two vertices one.
template <int D>
using Origin = std::array<std::uint64_t, D + 1>;
constexpr std::uint64_t none = UINT64_MAX;

struct OriginHash {
  template <std::size_t N>
  std::size_t operator()(const std::array<std::uint64_t, N>& origin) const noexcept {
    std::uint64_t hash = 0;
    for (const std::uint64_t point : origin) hash = (hash ^ (hash >> 29) ^ point) * 0x9e3779b97f4a7c15;
    return hash ^ hash >> 32;
  }
};

// The vertices that cells to come may have too. Cells come in memory order, so layer by layer along the last
// axis that has more than one: what lies below a layer, or between its two sides, is never met again.
template <int D>
class KnownVertices {
 public:
  enum Side { below, between, above };

  explicit KnownVertices(const std::array<std::int64_t, D>& dims) {
    while (axis_ > 0 && dims[axis_] == 2) --axis_;
  }
  int axis() const { return axis_; }

  void enter(const std::array<std::int64_t, D>& cell) {
    if (cell[axis_] == layer_) return;
    layer_ = cell[axis_];
    std::swap(sides_[below], sides_[above]);
    sides_[above].clear();
    sides_[between].clear();
  }
  // The number of the vertex; `next` if it is new.
  std::uint64_t number(Side side, const Origin<D>& origin, std::uint64_t next) {
    return sides_[side].try_emplace(origin, next).first->second;
  }
  std::uint64_t bytes() const {
    std::uint64_t sum = 0;
    for (const Vertices& side : sides_) sum += side.size() * node_bytes + side.bucket_count() * bucket_bytes;
    return sum;
  }

 private:
  using Vertices = std::unordered_map<Origin<D>, std::uint64_t, OriginHash>;
  // With what the heap adds; the buckets with those that they are about to be moved to.
  static constexpr std::uint64_t node_bytes = sizeof(typename Vertices::value_type) + sizeof(void*) + 16,
                                 bucket_bytes = 3 * sizeof(void*);

  int axis_ = D - 1;
  std::int64_t layer_ = 0;
  std::array<Vertices, 3> sides_;
};

// The samples at the corners of a cell.
template <int D>
struct CellSamples {
  LabelSet<D> labels = 0;
  std::array<double, 1 << D> values;
  bool active = false; // labels differ, and none is missing

  CellSamples(const Samples<D>& samples, const RowKernels& kernels, const std::array<std::int64_t, D>& cell) {
    unsigned inside = 0;
    for (unsigned corner = 0; corner < 1u << D; ++corner) {
      const auto index = corner_of(cell, corner);
      const std::byte* sample = samples.at(index); // a row of one sample
      std::uint64_t word = 0;
      std::uint8_t uniform = 0;
      if (kernels.inside({sample, 1, 0, 1}, samples.test_in_layer(index[D - 1]), &word, &uniform)) return;
      values[corner] = visit_sample_type(samples.test.type, [&](auto value) {
        std::memcpy(&value, sample, sizeof value);
        return static_cast<double>(value);
      });
      if (!samples.levels.empty()) values[corner] -= samples.levels[static_cast<std::size_t>(index[D - 1])];
      labels |= static_cast<LabelSet<D>>(word & 1) << corner;
      inside += word & 1;
    }
    active = inside != 0 && inside != 1u << D;
  }
};

// Faces of the subdivision of a cell, by its dimension.
constexpr std::array<std::uint64_t, 6> most_vertices{0, 0, 17, 149, 1729, 24965};

// The values at the corners of an active cell -> its simplices.
template <int D>
class CellMesher {
 public:
  CellMesher(const Samples<D>& samples, bool mirrored, const ExtractOptions& options, SimplexMesh<D>& mesh)
      : samples_(samples), options_(options), mirrored_(mirrored), isovalue_(samples.isovalue),
        above_(isovalue_), below_(isovalue_), is_above_(options.inside == Inside::above),
        cuts_(cuts<D>(options.cut)), known_(samples.dims), mesh_(mesh) {
    std::uint64_t stride = 1;
    for (int axis = 0; axis < D; ++axis) {
      strides_[axis] = stride;
      stride *= 2 * static_cast<std::uint64_t>(samples.dims[axis]) - 1;
    }
  }

  // First each cell is counted, so that it is known how many simplices there will be; then each is added.
  Status count_cell(const std::array<std::int64_t, D>& cell, const CellSamples<D>& samples) {
    set_points(cell, samples);
    for (const Flag<D>& flag : flags_) simplices_ += cuts_[positive_points(flag)].size();
    ++mesh_.active_cells;
    return check_memory();
  }
  void end_counting() {
    mesh_.simplices.reset(static_cast<std::size_t>(simplices_) * D, has_wide_indices());
    // Room for about as many vertices as there will be; what of it is not used, the system never gives.
    mesh_.positions.reset(static_cast<std::size_t>(simplices_ / (D - 1)) * D,
                          options_.precision == Precision::f64);
    mesh_.positions.resize(0);
  }
  Status add_cell(const std::array<std::int64_t, D>& cell, const CellSamples<D>& samples) {
    known_.enter(cell);
    set_points(cell, samples);
    for (const Flag<D>& flag : flags_)
      for (const auto& simplex : cuts_[positive_points(flag)]) {
        const bool turned = flag.positive == mirrored_;
        for (std::size_t k = 0; k < D; ++k)
          mesh_.simplices.set(corners_++, vertex(flag, simplex[turned && k < 2 ? 1 - k : k]));
      }
    return check_memory();
  }

 private:
  struct Point {
    std::uint64_t number;
    std::array<double, D> position;
    double value;
    unsigned place; // 0, 1 or 2, along the axis of layers
    bool inside;
  };

  void set_points(const std::array<std::int64_t, D>& cell, const CellSamples<D>& samples) {
    for (unsigned point = 0; point < cell_points<D>; ++point)
      set_point(cell, point, samples.labels, samples.values);
  }

  void set_point(const std::array<std::int64_t, D>& cell, unsigned local, const LabelSet<D>& labels,
                 const std::array<double, 1 << D>& values) {
    Point& point = points_[local];
    point.number = 0;
    unsigned lowest = 0, along = 0, rest = local; // corner and axes of the face
    for (int axis = 0; axis < D; ++axis, rest /= 3) {
      const unsigned place = rest % 3;
      const auto index = static_cast<std::size_t>(cell[axis]);
      const double low = samples_.coordinates[axis][index], high = samples_.coordinates[axis][index + 1];
      point.number += (2 * static_cast<std::uint64_t>(cell[axis]) + place) * strides_[axis];
      point.position[axis] = place == 0 ? low : place == 2 ? high : low + (high - low) / 2;
      if (axis == known_.axis()) point.place = place;
      if (place == 2) lowest |= 1u << axis;
      if (place == 1) along |= 1u << axis;
    }
    if (along == 0) {
      point.value = values[lowest];
      point.inside = label_of<D>(labels, lowest);
      return;
    }
    // A face whose corners are all on one side must not have its centre on the other by rounding: the cell
    // beyond it may not be looked at.
    double sum = 0, least = values[lowest], greatest = least;
    for (unsigned corner = along;; corner = (corner - 1) & along) {
      const double value = values[lowest | corner];
      sum += value;
      least = std::min(least, value);
      greatest = std::max(greatest, value);
      if (corner == 0) break;
    }
    const double mean = std::ldexp(sum, -std::popcount(along));
    point.value = std::isnan(mean) ? isovalue_ : std::clamp(mean, least, greatest); // NaN: between infinities
    point.inside = is_above_ ? above_.inside(point.value) : below_.inside(point.value);
  }

  // Which points of the flag are inside, a bit for each.
  unsigned positive_points(const Flag<D>& flag) const {
    unsigned positive = 0;
    for (unsigned corner = 0; corner <= D; ++corner)
      positive |= static_cast<unsigned>(points_[flag.points[corner]].inside) << corner;
    return positive;
  }

  std::uint64_t vertex(const Flag<D>& flag, unsigned face) {
    Origin<D> origin;
    origin.fill(none);
    std::size_t size = 0;
    unsigned places = 0; // a bit for each of 0, 1, 2
    for (unsigned rest = face; rest != 0; rest &= rest - 1) {
      const Point& point = points_[flag.points[static_cast<unsigned>(std::countr_zero(rest))]];
      origin[size++] = point.number;
      places |= 1u << point.place;
    }
    using Known = KnownVertices<D>;
    const auto side = places == 1 ? Known::below : places == 4 ? Known::above : Known::between;
    const std::uint64_t number = known_.number(side, origin, vertices_);
    if (number == vertices_) add_vertex(middle(flag, face));
    return number;
  }

  void add_vertex(const std::array<double, D>& position) {
    const auto first = static_cast<std::size_t>(vertices_++) * D;
    mesh_.positions.resize(first + D);
    for (std::size_t axis = 0; axis < D; ++axis) mesh_.positions.set(first + axis, position[axis]);
  }

  // The mean of the points where the surface crosses the edges of the face.
  std::array<double, D> middle(const Flag<D>& flag, unsigned face) const {
    std::array<double, D> sum{};
    double crossings = 0;
    for (unsigned lower = 0; lower <= D; ++lower)
      for (unsigned upper = lower + 1; upper <= D; ++upper) {
        if (!(face >> lower & face >> upper & 1)) continue;
        const Point &a = points_[flag.points[lower]], &b = points_[flag.points[upper]];
        if (a.inside == b.inside) continue;
        const double weight = crossing(a.value, b.value, isovalue_);
        for (int axis = 0; axis < D; ++axis)
          sum[axis] += a.position[axis] + weight * (b.position[axis] - a.position[axis]);
        ++crossings;
      }
    for (double& coordinate : sum) coordinate /= crossings;
    return sum;
  }

  bool has_wide_indices() const { return mesh_.active_cells > UINT32_MAX / most_vertices[D]; }

  Status check_memory() const { // so far
    const std::uint64_t bytes = simplices_ * D * bytes_per_index(has_wide_indices()) +
                                vertices_ * bytes_per_vertex(D, options_.precision == Precision::f64, false) +
                                known_.bytes();
    if (bytes > options_.memory_limit) return more_than_fits(vertices_, simplices_, options_.memory_limit);
    return {};
  }

  const Samples<D>& samples_;
  const ExtractOptions& options_;
  const bool mirrored_;
  const double isovalue_;
  const SignRule<double, true> above_;
  const SignRule<double, false> below_;
  const bool is_above_;
  const std::vector<std::vector<typename MidpointCut<D>::Simplex>> cuts_;
  const std::vector<Flag<D>> flags_ = flags<D>();
  std::array<std::uint64_t, D> strides_; // of the grid of all points

  std::array<Point, cell_points<D>> points_; // of the current cell
  KnownVertices<D> known_;
  SimplexMesh<D>& mesh_;
  std::uint64_t vertices_ = 0, simplices_ = 0;
  std::size_t corners_ = 0;
};

// Calls use(cell, samples) for each active cell, in memory order, until it fails. Tells its progress from
// `begin` to `end`.
template <int D, class Use>
Status for_each_active_cell(const Samples<D>& samples, const Progress& progress, double begin, double end,
                            Use&& use) {
  const RowKernels kernels = row_kernels(samples.test.type, best_instructions());
  Status status;
  for_each_cell<D>(samples.dims, [&](const std::array<std::int64_t, D>& cell) {
    if (cell[0] == 0 && progress) {
      const double share = static_cast<double>(cell[D - 1]) / static_cast<double>(samples.dims[D - 1] - 1);
      if (!progress(std::lerp(begin, end, share)))
        return status = Error{Code::cancelled, "the extraction was cancelled"}, false;
    }
    const CellSamples<D> corners(samples, kernels, cell);
    if (corners.active) status = use(cell, corners);
    return static_cast<bool>(status);
  });
  return status;
}

} // namespace

template <int D>
Status extract_barycentric(const Samples<D>& samples, TableForm form, const ExtractOptions& options,
                           SimplexMesh<D>& mesh) {
  constexpr double counting_share = 0.02;
  mesh.edges.clear(); // the vertices are not on edges of the grid
  mesh.active_cells = 0;
  CellMesher<D> mesher(samples, form.mirrored, options, mesh);
  Status status = for_each_active_cell(
      samples, options.progress, 0, counting_share,
      [&](const auto& cell, const auto& corners) { return mesher.count_cell(cell, corners); });
  if (!status) return status;
  mesher.end_counting();
  return for_each_active_cell(
      samples, options.progress, counting_share, 1,
      [&](const auto& cell, const auto& corners) { return mesher.add_cell(cell, corners); });
}

template Status extract_barycentric(const Samples<2>&, TableForm, const ExtractOptions&, SimplexMesh<2>&);
template Status extract_barycentric(const Samples<3>&, TableForm, const ExtractOptions&, SimplexMesh<3>&);
template Status extract_barycentric(const Samples<4>&, TableForm, const ExtractOptions&, SimplexMesh<4>&);
template Status extract_barycentric(const Samples<5>&, TableForm, const ExtractOptions&, SimplexMesh<5>&);

} // namespace hyperiso
