// Two relative interiors have no common point iff a hyperplane separates the simplices properly: none crosses
// it, and not both lie within it (Rockafellar, Convex Analysis, theorem 11.3). The functionals that separate
// them form a cone. Where the corners of both span the space it is pointed, so that if there is any there is
// an extreme one, which is 0 on corners that span a hyperplane: it suffices to try the hyperplanes through
// corners. Where the corners lie in one hyperplane, that is projected along an axis first.
//
// Sides of hyperplanes are computed in doubles, with a bound on the error; where that does not decide, in
// integers.
#include "mesh/simplex_pair.hpp"

#include "mesh/exact_integer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

namespace hyperiso {

namespace {

constexpr std::size_t most_axes = 8, most_points = 2 * (most_axes + 1);

// A computed number, and the sum of the absolute values of all products that it is made of, which bounds its
// error.
struct Approximation {
  double value = 0, magnitude = 0;
};

// A sum of products.
void add_product(Approximation& sum, Approximation a, Approximation b, bool positive) {
  const double product = a.value * b.value;
  sum.value += positive ? product : -product;
  sum.magnitude += a.magnitude * b.magnitude;
}
void add_product(ExactInteger& sum, const ExactInteger& a, const ExactInteger& b, bool positive) {
  positive ? sum += a* b : sum -= a * b;
}

// The minors of the first 1, 2, ... of `columns - 1` rows of `entry(row, column)`, by the sets of columns
// that they take. Those of all columns but one are the coefficients of one more row in the determinant.
template <class Number, class Entry>
std::vector<Number> minors(std::size_t columns, const Number& one, Entry&& entry) {
  std::vector<Number> minors(std::size_t{1} << columns);
  minors[0] = one;
  for (unsigned set = 1; set + 1 < minors.size(); ++set) {
    const auto row = static_cast<std::size_t>(std::popcount(set)) - 1;
    bool positive = true; // the last column of the last row
    for (std::size_t k = columns; k-- > 0;) {
      if (!(set >> k & 1)) continue;
      add_product(minors[set], entry(row, k), minors[set ^ 1u << k], positive);
      positive = !positive;
    }
  }
  return minors;
}

// Points, and the sides of hyperplanes through some of them that the others are on.
class Sides {
 public:
  explicit Sides(std::size_t dimension) : axis_count_(dimension) {
    for (std::size_t axis = 0; axis < dimension; ++axis) axes_[axis] = axis;
  }
  // Returns its number.
  std::size_t add_point(const double* point) {
    points_[point_count_] = point;
    return point_count_++;
  }
  std::size_t point_count() const { return point_count_; }
  std::size_t dimension() const { return axis_count_; }

  // Takes the hyperplane through `dimension()` points.
  void set_hyperplane(std::span<const std::size_t> points) {
    std::ranges::copy(points, hyperplane_.begin());
    exact_minors_.clear();
    safe_ = true;
    minors_ = minors(axis_count_, Approximation{1, 1},
                     [&](std::size_t row, std::size_t k) { return difference(hyperplane_[row + 1], k); });
  }
  // -1, 0, 1: below, on, above; all 0 if the points do not span a hyperplane.
  int side(std::size_t point) {
    if (std::find(hyperplane_.begin(), hyperplane_.begin() + axis_count_, point) !=
        hyperplane_.begin() + axis_count_)
      return 0;
    Approximation sum;
    for (std::size_t k = 0; k < axis_count_; ++k)
      add_product(sum, difference(point, k), minors_[all() ^ 1u << k], k % 2 == 0);
    if (const int sign = certain_sign(sum); sign != unsure) return sign;
    find_exact_minors();
    ExactInteger exact;
    for (std::size_t k = 0; k < axis_count_; ++k)
      add_product(exact, exact_difference(point, k), exact_minors_[all() ^ 1u << k], k % 2 == 0);
    return exact.sign();
  }
  // Leaves out the axis along which the hyperplane's normal is not 0; false if there is no normal.
  bool project_along_normal() {
    for (std::size_t k = 0; k < axis_count_; ++k) {
      int sign = certain_sign(minors_[all() ^ 1u << k]);
      if (sign == unsure) {
        find_exact_minors();
        sign = exact_minors_[all() ^ 1u << k].sign();
      }
      if (sign == 0) continue;
      std::copy(axes_.begin() + k + 1, axes_.begin() + axis_count_, axes_.begin() + k);
      --axis_count_;
      return true;
    }
    return false;
  }

 private:
  static constexpr int unsure = 2;

  unsigned all() const { return (1u << axis_count_) - 1; }

  Approximation difference(std::size_t point, std::size_t k) {
    const double x = points_[point][axes_[k]] - points_[hyperplane_[0]][axes_[k]];
    const double size = std::abs(x);
    if (x != 0 && !(size > 0x1p-100 && size < 0x1p100)) safe_ = false; // products might underflow or overflow
    return {x, size};
  }
  // Each number is a sum of at most 8! products of at most 8 differences; on the way to it less than 128
  // roundings change a product by 2^-53 of itself each.
  int certain_sign(Approximation sum) const {
    if (!safe_) return unsure;
    if (sum.magnitude == 0) return 0; // every product has a factor that is exactly 0
    if (std::abs(sum.value) > 0x1p-46 * sum.magnitude) return sum.value > 0 ? 1 : -1;
    return unsure;
  }

  ExactInteger exact_difference(std::size_t point, std::size_t k) {
    ExactInteger x(points_[point][axes_[k]], *shift_);
    x -= ExactInteger(points_[hyperplane_[0]][axes_[k]], *shift_);
    return x;
  }
  void find_shift() {
    shift_ = 0;
    for (std::size_t point = 0; point < point_count_; ++point)
      for (std::size_t k = 0; k < axis_count_; ++k)
        if (const double x = points_[point][axes_[k]]; x != 0) shift_ = std::max(*shift_, -lowest_bit(x));
  }
  void find_exact_minors() {
    if (!exact_minors_.empty()) return;
    if (!shift_) find_shift();
    exact_minors_ = minors(axis_count_, ExactInteger(1, 0), [&](std::size_t row, std::size_t k) {
      return exact_difference(hyperplane_[row + 1], k);
    });
  }

  std::array<const double*, most_points> points_{};
  std::size_t point_count_ = 0, axis_count_;
  std::array<std::size_t, most_axes> axes_{}, hyperplane_{};
  std::vector<Approximation> minors_;
  std::vector<ExactInteger> exact_minors_; // empty: not needed so far
  std::optional<int> shift_;               // that makes all coordinates integers
  bool safe_ = true;
};

class SimplexPair {
 public:
  SimplexPair(std::size_t dimension, std::span<const double* const> a, std::span<const double* const> b)
      : sides_(dimension) {
    for (const double* point : a)
      if (std::ranges::find(b, point) != b.end()) add(point, true, true);
    for (const double* point : a)
      if (std::ranges::find(b, point) == b.end()) add(point, true, false);
    for (const double* point : b)
      if (std::ranges::find(a, point) == a.end()) add(point, false, true);
  }

  bool interiors_meet() {
    if (in_a_.size() == sides_.dimension()) { // surfaces
      sides_.set_hyperplane(in_a_);
      const Placement b_to_a = place();
      if (b_to_a == Placement::separated) return false;
      if (b_to_a == Placement::within) {
        if (!sides_.project_along_normal()) return false;
      } else {
        sides_.set_hyperplane(in_b_);
        const Placement a_to_b = place();
        if (a_to_b != Placement::crossing) return false; // `within`: b has no content
      }
    }
    if (in_a_.size() == sides_.dimension() + 1 && (!has_content(in_a_) || !has_content(in_b_))) return false;
    return !any_hyperplane_separates();
  }

 private:
  enum class Placement { separated, within, crossing };

  void add(const double* point, bool of_a, bool of_b) {
    const std::size_t number = sides_.add_point(point);
    if (of_a) in_a_.push_back(number);
    if (of_b) in_b_.push_back(number);
  }

  // How the simplices lie to the current hyperplane.
  Placement place() {
    unsigned sides_of_a = 0, sides_of_b = 0; // bit 0: below, bit 2: above
    std::array<unsigned, most_points> side;
    for (std::size_t point = 0; point < sides_.point_count(); ++point)
      side[point] = 1u << (sides_.side(point) + 1);
    for (const std::size_t point : in_a_) sides_of_a |= side[point];
    for (const std::size_t point : in_b_) sides_of_b |= side[point];
    constexpr unsigned below = 1, above = 4;
    sides_of_a &= below | above;
    sides_of_b &= below | above;
    if ((sides_of_a | sides_of_b) == 0) return Placement::within;
    const bool a_one_sided = sides_of_a != (below | above), b_one_sided = sides_of_b != (below | above);
    return a_one_sided && b_one_sided && (sides_of_a & sides_of_b) == 0 ? Placement::separated
                                                                        : Placement::crossing;
  }

  bool has_content(const std::vector<std::size_t>& simplex) {
    sides_.set_hyperplane(std::span(simplex).first(sides_.dimension()));
    return sides_.side(simplex.back()) != 0;
  }

  // Tries those with common corners first.
  bool any_hyperplane_separates() {
    std::vector<std::size_t> chosen(sides_.dimension());
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = i;
    for (;;) {
      sides_.set_hyperplane(chosen);
      if (place() == Placement::separated) return true;
      std::size_t last = chosen.size();
      while (last > 0 && chosen[last - 1] == sides_.point_count() - chosen.size() + last - 1) --last;
      if (last == 0) return false;
      ++chosen[last - 1];
      for (std::size_t i = last; i < chosen.size(); ++i) chosen[i] = chosen[i - 1] + 1;
    }
  }

  Sides sides_;
  std::vector<std::size_t> in_a_, in_b_;
};

} // namespace

bool interiors_meet(std::size_t dimension, std::span<const double* const> a,
                    std::span<const double* const> b) {
  return SimplexPair(dimension, a, b).interiors_meet();
}

} // namespace hyperiso
