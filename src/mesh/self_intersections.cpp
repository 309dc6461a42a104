#include "hyperiso/self_intersections.hpp"

#include "core/text.hpp"
#include "mesh/simplex_pair.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

namespace hyperiso {
namespace {

constexpr int most_dimensions = 8;

// An interval per axis, which may be a point.
struct Box {
  std::array<double, most_dimensions> low, high;
  unsigned flat = 0; // bit k: of a simplex, the interval is a point; of several, that of one of them is
};

// Simplices in a binary tree by the places of their boxes.
class BoxTree {
 public:
  BoxTree(std::size_t dimension, std::vector<Box> boxes) : dimension_(dimension), boxes_(std::move(boxes)) {
    order_.resize(boxes_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!order_.empty()) build(0, order_.size());
  }

  // Calls use(i, j) for each two boxes i, j whose relative interiors meet, until it returns false.
  // `use` may also be asked with the share that is done.
  template <class Use, class Report>
  bool for_each_overlap(Use&& use, Report&& report) const {
    return nodes_.empty() || within(0, use, report);
  }

 private:
  static constexpr std::size_t leaf_size = 8;

  struct Node {
    Box box;
    std::size_t begin, end;  // in order_
    std::size_t upper_child; // the lower one follows its parent; 0: a leaf
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({boxes_[order_[begin]], begin, end, 0});
    for (std::size_t i = begin + 1; i < end; ++i)
      nodes_[node].box = joined(nodes_[node].box, boxes_[order_[i]]);
    if (end - begin <= leaf_size) return node;
    const Box& box = nodes_[node].box;
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < dimension_; ++axis)
      if (box.high[axis] - box.low[axis] > box.high[longest] - box.low[longest]) longest = axis;
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                     order_.begin() + static_cast<std::ptrdiff_t>(middle),
                     order_.begin() + static_cast<std::ptrdiff_t>(end), [&](std::size_t i, std::size_t j) {
                       const Box &a = boxes_[i], &b = boxes_[j];
                       const double at = a.low[longest] + a.high[longest],
                                    bt = b.low[longest] + b.high[longest];
                       return at != bt ? at < bt : i < j;
                     });
    build(begin, middle);
    const std::size_t upper = build(middle, end);
    nodes_[node].upper_child = upper;
    return node;
  }

  Box joined(Box a, const Box& b) const {
    for (std::size_t axis = 0; axis < dimension_; ++axis) {
      a.low[axis] = std::min(a.low[axis], b.low[axis]);
      a.high[axis] = std::max(a.high[axis], b.high[axis]);
    }
    a.flat |= b.flat;
    return a;
  }

  // Whether boxes within these two, or these, may meet in their relative interiors: intervals that only touch
  // do if they are the same point.
  bool may_meet(const Box& a, const Box& b) const {
    for (std::size_t axis = 0; axis < dimension_; ++axis) {
      if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return false;
      const bool touch = a.high[axis] == b.low[axis] || b.high[axis] == a.low[axis];
      if (touch && !(a.flat & b.flat & 1u << axis)) return false;
    }
    return true;
  }

  template <class Use, class Report>
  bool within(std::size_t number, Use& use, Report& report) const {
    const Node& node = nodes_[number];
    if (node.upper_child == 0) {
      for (std::size_t i = node.begin; i < node.end; ++i)
        for (std::size_t j = node.begin; j < i; ++j)
          if (may_meet(boxes_[order_[i]], boxes_[order_[j]])) use(order_[i], order_[j]);
      return report(static_cast<double>(node.end) / static_cast<double>(order_.size()));
    }
    return within(number + 1, use, report) && within(node.upper_child, use, report) &&
           (between(number + 1, node.upper_child, use), true);
  }
  template <class Use>
  void between(std::size_t a_number, std::size_t b_number, Use& use) const {
    const Node &a = nodes_[a_number], &b = nodes_[b_number];
    if (!may_meet(a.box, b.box)) return;
    if (a.upper_child != 0 && (b.upper_child == 0 || a.end - a.begin >= b.end - b.begin)) {
      between(a_number + 1, b_number, use);
      between(a.upper_child, b_number, use);
    } else if (b.upper_child != 0) {
      between(a_number, b_number + 1, use);
      between(a_number, b.upper_child, use);
    } else {
      for (std::size_t i = a.begin; i < a.end; ++i)
        for (std::size_t j = b.begin; j < b.end; ++j)
          if (may_meet(boxes_[order_[i]], boxes_[order_[j]])) use(order_[i], order_[j]);
    }
  }

  std::size_t dimension_;
  std::vector<Box> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

// Simplices by their corners' coordinates.
class Simplices {
 public:
  explicit Simplices(const Mesh& mesh)
      : dimension_(static_cast<std::size_t>(mesh.dimension)),
        corner_count_(static_cast<std::size_t>(mesh.simplex_dimension) + 1),
        positions_(mesh.positions.size()), mesh_(mesh) {
    for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] = mesh.positions[i];
  }

  std::array<const double*, most_dimensions + 1> corners(std::size_t simplex) const {
    std::array<const double*, most_dimensions + 1> corners{};
    for (std::size_t k = 0; k < corner_count_; ++k)
      corners[k] = positions_.data() + mesh_.simplices[simplex * corner_count_ + k] * dimension_;
    return corners;
  }
  Box box(std::size_t simplex) const {
    Box box;
    const auto points = corners(simplex);
    for (std::size_t axis = 0; axis < dimension_; ++axis) {
      box.low[axis] = box.high[axis] = points[0][axis];
      for (std::size_t k = 1; k < corner_count_; ++k) {
        box.low[axis] = std::min(box.low[axis], points[k][axis]);
        box.high[axis] = std::max(box.high[axis], points[k][axis]);
      }
      if (box.low[axis] == box.high[axis]) box.flat |= 1u << axis;
    }
    return box;
  }
  bool meet(std::size_t i, std::size_t j) const {
    const auto a = corners(i), b = corners(j);
    return interiors_meet(dimension_, std::span(a).first(corner_count_), std::span(b).first(corner_count_));
  }

 private:
  std::size_t dimension_, corner_count_;
  std::vector<double> positions_;
  const Mesh& mesh_;
};

Status check(const Mesh& mesh) {
  if (mesh.dimension < 2 || mesh.dimension > most_dimensions || mesh.simplex_dimension < mesh.dimension - 1 ||
      mesh.simplex_dimension > mesh.dimension)
    return Error{Code::invalid_argument,
                 text("cannot look for intersections of ", mesh.simplex_dimension, "-simplices in ",
                      mesh.dimension, " dimensions; surfaces and volumes in 2 to ", most_dimensions, " can")};
  const std::size_t vertices = mesh.vertex_count();
  for (std::size_t i = 0; i < mesh.simplices.size(); ++i)
    if (mesh.simplices[i] >= vertices)
      return Error{Code::invalid_argument,
                   text("a simplex names vertex ", mesh.simplices[i], "; the mesh has ", vertices)};
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!std::isfinite(mesh.positions[i]))
      return Error{Code::invalid_argument,
                   text("a coordinate of vertex ", i / static_cast<std::size_t>(mesh.dimension), " is ",
                        mesh.positions[i], "; all must be finite")};
  return {};
}

// Notes a pair, in order, as long as few are noted that come before it.
void note(SelfIntersections& found, std::size_t i, std::size_t j) {
  ++found.pairs;
  const std::array<std::uint64_t, 2> pair{std::min(i, j), std::max(i, j)};
  found.examples.insert(std::ranges::upper_bound(found.examples, pair), pair);
  if (found.examples.size() > SelfIntersections::kept) found.examples.pop_back();
}

} // namespace

Result<SelfIntersections> find_self_intersections(const Mesh& mesh, const Progress& progress) {
  if (Status status = check(mesh); !status) return status.error();
  try {
    const Simplices simplices(mesh);
    std::vector<Box> boxes;
    for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex)
      boxes.push_back(simplices.box(simplex));
    const BoxTree tree(static_cast<std::size_t>(mesh.dimension), std::move(boxes));
    SelfIntersections found;
    const bool finished = tree.for_each_overlap(
        [&](std::size_t i, std::size_t j) {
          if (simplices.meet(i, j)) note(found, i, j);
        },
        [&](double share) { return !progress || progress(share); });
    if (!finished) return Error{Code::cancelled, "the search for intersections was cancelled"};
    return found;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to look for intersections of ", mesh.simplex_count(), " simplices")};
  }
}

} // namespace hyperiso
