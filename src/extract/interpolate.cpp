#include "hyperiso/interpolate.hpp"

#include "core/sign.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hyperiso {
namespace {

// The two samples of the grid edge of a vertex, by their indices in a field.
struct Ends {
  std::vector<std::int64_t> lower, upper;
};

// From the grid edges of a mesh to samples of a field whose grid it lies on.
class EdgeEnds {
 public:
  static Result<EdgeEnds> of(const Mesh& mesh, const Field& field) {
    if (mesh.edges.size() != mesh.vertex_count() || mesh.grid_axes.empty())
      return Error{Code::invalid_argument,
                   "the mesh has no grid edges, by which its vertices are found among "
                   "the samples (the barycentric method gives none)"};
    if (mesh.grid_axes.size() != field.info.axes.size())
      return Error{Code::invalid_argument, text("the mesh lies on a grid of ", mesh.grid_axes.size(),
                                                " axes, but the field has ", field.info.axes.size())};
    EdgeEnds ends;
    for (std::size_t axis = 0; axis < mesh.grid_axes.size(); ++axis) {
      const Axis &of_mesh = mesh.grid_axes[axis], &of_field = field.info.axes[axis];
      ends.dims_.push_back(of_mesh.count);
      ends.first_.push_back(of_mesh.first - of_field.first);
      if (mesh.vertex_count() > 0 &&
          (ends.first_.back() < 0 || ends.first_.back() + of_mesh.count > of_field.count))
        return Error{Code::invalid_argument,
                     text("the mesh lies on samples ", of_mesh.first, " to ",
                          of_mesh.first + of_mesh.count - 1, " along axis ", axis, ", but the field has ",
                          of_field.first, " to ", of_field.first + of_field.count - 1)};
    }
    return ends;
  }

  void find(GridEdge edge, Ends& ends) const {
    const std::size_t D = dims_.size();
    ends.lower.resize(D);
    ends.upper.resize(D);
    const auto nx = static_cast<GridEdge>(dims_[0]);
    ends.upper[0] = static_cast<std::int64_t>(edge % nx);
    const GridEdge direction = edge / nx & ((GridEdge{1} << D) - 1);
    auto row = static_cast<std::int64_t>(edge / nx >> D);
    for (std::size_t axis = 1; axis < D; ++axis) {
      ends.upper[axis] = row % dims_[axis];
      row /= dims_[axis];
    }
    for (std::size_t axis = 0; axis < D; ++axis) {
      ends.upper[axis] += first_[axis];
      ends.lower[axis] = ends.upper[axis] - static_cast<std::int64_t>(direction >> axis & 1);
    }
  }

 private:
  std::vector<std::int64_t> dims_, first_; // of the mesh's grid, and where it begins in the field
};

template <class T>
class SamplesOf {
 public:
  explicit SamplesOf(const Field& field)
      : field_(field), samples_(reinterpret_cast<const T*>(field.samples.get())) {}

  double at(const std::vector<std::int64_t>& index) const {
    return static_cast<double>(samples_[offset(index)]);
  }
  // The derivative along an axis.
  double slope(const std::vector<std::int64_t>& index, std::size_t axis) const {
    const Axis& coordinates = field_.info.axes[axis];
    const std::int64_t i = index[axis], here = offset(index), stride = field_.strides[axis];
    const auto towards = [&](std::int64_t step) {
      if (i + step < 0 || i + step >= coordinates.count) return std::nan("");
      const auto difference =
          static_cast<double>(samples_[here + step * stride]) - static_cast<double>(samples_[here]);
      return difference / (coordinates.coordinate(i + step) - coordinates.coordinate(i));
    };
    const double before = towards(-1), after = towards(1);
    if (!std::isfinite(before)) return std::isfinite(after) ? after : 0;
    if (!std::isfinite(after)) return before;
    const double step_before = std::abs(coordinates.coordinate(i) - coordinates.coordinate(i - 1)),
                 step_after = std::abs(coordinates.coordinate(i + 1) - coordinates.coordinate(i));
    return (step_after * before + step_before * after) / (step_before + step_after);
  }

 private:
  std::int64_t offset(const std::vector<std::int64_t>& index) const {
    std::int64_t sum = 0;
    for (std::size_t axis = 0; axis < index.size(); ++axis) sum += index[axis] * field_.strides[axis];
    return sum;
  }
  const Field& field_;
  const T* samples_;
};

double between(double lower, double upper, double weight) {
  if (weight == 0) return lower;
  return weight == 1 ? upper : lower + weight * (upper - lower);
}

Status check_weights(const Mesh& mesh, std::span<const double> weights) {
  if (weights.size() == mesh.vertex_count()) return {};
  return Error{Code::invalid_argument,
               text("there are ", weights.size(), " weights for ", mesh.vertex_count(), " vertices")};
}

// Calls use(vertex, ends, samples) for every vertex, with the samples in the field's own type.
template <class Use>
Status for_each_vertex(const Mesh& mesh, const Field& field, Use&& use) {
  const auto edges = EdgeEnds::of(mesh, field);
  if (!edges) return edges.error();
  visit_sample_type(field.info.type, [&]<class T>(T) {
    const SamplesOf<T> samples(field);
    Ends ends;
    for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      edges->find(mesh.edges[vertex], ends);
      use(vertex, ends, samples);
    }
  });
  return {};
}

// An attribute as precise as the positions are.
Attribute attribute_of(const Mesh& mesh, std::string name, int components, std::vector<double> values) {
  Attribute attribute{std::move(name), Attribute::Location::vertex, components, {}};
  if (mesh.positions.wide())
    attribute.values = std::move(values);
  else
    attribute.values = std::vector<float>(values.begin(), values.end());
  return attribute;
}

Error out_of_memory(const Mesh& mesh) {
  return {Code::out_of_memory, text("not enough memory for the data of ", mesh.vertex_count(), " vertices")};
}

Status check_same_grid(const NamedField& other, const Field& field) {
  if (other.field.info.axes.size() != field.info.axes.size())
    return Error{Code::invalid_argument, text("'", other.name, "' has ", other.field.info.axes.size(),
                                              " axes, but the field has ", field.info.axes.size())};
  for (std::size_t number = 0; number < field.info.axes.size(); ++number) {
    const Axis &a = other.field.info.axes[number], &b = field.info.axes[number];
    if (a.count != b.count)
      return Error{Code::invalid_argument, text("'", other.name, "' has ", a.count, " samples along axis ",
                                                number, ", but the field has ", b.count)};
    for (std::int64_t i = 0; i < a.count; ++i)
      if (a.coordinate(i) != b.coordinate(i))
        return Error{Code::invalid_argument,
                     text("'", other.name, "' is not on the grid of the field: sample ", i, " along axis ",
                          number, " is at ", a.coordinate(i), ", not at ", b.coordinate(i))};
  }
  return {};
}

Status add(Mesh& mesh, Result<Attribute> attribute) {
  if (!attribute) return attribute.error();
  for (const Attribute& other : mesh.attributes)
    if (other.location == attribute->location && other.name == attribute->name)
      return Error{Code::invalid_argument, text("two data of the vertices are called '", attribute->name,
                                                "'; give one another name")};
  mesh.attributes.push_back(*std::move(attribute));
  return {};
}

} // namespace

Result<std::vector<double>> vertex_weights(const Mesh& mesh, const Field& field, double isovalue) {
  try {
    std::vector<double> weights(mesh.vertex_count());
    const Status done =
        for_each_vertex(mesh, field, [&](std::size_t vertex, const Ends& ends, auto& samples) {
          weights[vertex] = crossing(samples.at(ends.lower), samples.at(ends.upper), isovalue);
        });
    if (!done) return done.error();
    return weights;
  } catch (const std::bad_alloc&) {
    return out_of_memory(mesh);
  }
}

Result<Attribute> interpolate(const Mesh& mesh, std::span<const double> weights, const Field& field,
                              std::string name) {
  if (const Status valid = check_weights(mesh, weights); !valid) return valid.error();
  try {
    std::vector<double> values(mesh.vertex_count());
    const Status done =
        for_each_vertex(mesh, field, [&](std::size_t vertex, const Ends& ends, auto& samples) {
          values[vertex] = between(samples.at(ends.lower), samples.at(ends.upper), weights[vertex]);
        });
    if (!done) return done.error();
    return attribute_of(mesh, std::move(name), 1, std::move(values));
  } catch (const std::bad_alloc&) {
    return out_of_memory(mesh);
  }
}

Result<Attribute> normals(const Mesh& mesh, std::span<const double> weights, const Field& field,
                          Inside inside) {
  if (const Status valid = check_weights(mesh, weights); !valid) return valid.error();
  try {
    const std::size_t D = field.info.axes.size();
    std::vector<double> values(mesh.vertex_count() * D), gradient(D);
    const Status done =
        for_each_vertex(mesh, field, [&](std::size_t vertex, const Ends& ends, auto& samples) {
          double largest = 0, squared = 0; // scaled by the largest, so that squares stay in range
          for (std::size_t axis = 0; axis < D; ++axis) {
            gradient[axis] =
                between(samples.slope(ends.lower, axis), samples.slope(ends.upper, axis), weights[vertex]);
            largest = std::max(largest, std::abs(gradient[axis]));
          }
          if (largest == 0) return;
          for (double& slope : gradient) slope /= largest, squared += slope * slope;
          const double scale = (inside == Inside::above ? -1 : 1) / std::sqrt(squared);
          for (std::size_t axis = 0; axis < D; ++axis) values[vertex * D + axis] = scale * gradient[axis];
        });
    if (!done) return done.error();
    return attribute_of(mesh, normal_attribute, static_cast<int>(D), std::move(values));
  } catch (const std::bad_alloc&) {
    return out_of_memory(mesh);
  }
}

Status add_point_data(Mesh& mesh, const Field& field, double isovalue, Inside inside,
                      std::span<const NamedField> others, bool with_normals) {
  if (others.empty() && !with_normals) return {};
  for (const NamedField& other : others)
    if (const Status same = check_same_grid(other, field); !same) return same;
  const auto weights = vertex_weights(mesh, field, isovalue);
  if (!weights) return weights.error();
  if (with_normals)
    if (const Status added = add(mesh, normals(mesh, *weights, field, inside)); !added) return added;
  for (const NamedField& other : others) {
    Field on_grid = other.field;
    on_grid.info.axes = field.info.axes; // the same places, whatever it was cropped from
    if (const Status added = add(mesh, interpolate(mesh, *weights, on_grid, other.name)); !added)
      return added;
  }
  return {};
}

} // namespace hyperiso
