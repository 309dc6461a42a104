#include "hyperiso/extract.hpp"

#include "core/instantiate.hpp"
#include "core/text.hpp"
#include "extract/barycentric.hpp"
#include "extract/check_options.hpp"
#include "extract/extract_with.hpp"
#include "extract/reference.hpp"

#include <new>

namespace hyperiso {
namespace {

int highest_dimension(Method method) {
  if (method == Method::simplicial) return highest_simplicial_dimension;
  return method == Method::barycentric ? highest_barycentric_dimension : highest_hull_dimension;
}

Status check_dimension(Method method, int dimension) {
  if (dimension <= highest_dimension(method)) return {};
  return Error{Code::unsupported_dimension,
               text("the field has ", dimension, " dimensions; the methods hull and component work in up to ",
                    highest_hull_dimension, ", barycentric in up to ", highest_barycentric_dimension,
                    ", simplicial in up to ", highest_simplicial_dimension)};
}

// What counts against the limit of memory.
std::uint64_t memory_of(const Mesh& mesh) {
  return mesh.positions.bytes() + mesh.edges.size() * sizeof(GridEdge) + mesh.simplices.bytes();
}

} // namespace

template <class T, int D>
Status extract_into(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                    SimplexMesh<D>& mesh) {
  if (Status status = check_arguments(isovalue, options.threads); !status) return status;
  if (Status status = check_dimension(options.method, D); !status) return status;
  try {
    if constexpr (D <= 5)
      return extract_with(field, isovalue, options, EngineOptions{}, mesh);
    else
      return extract_plainly(field, isovalue, options, mesh);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the surface"};
  }
}

template <class T, int D>
Result<SimplexMesh<D>> extract(const FieldView<const T, D>& field, double isovalue,
                               const ExtractOptions& options) {
  SimplexMesh<D> mesh;
  if (Status status = extract_into(field, isovalue, options, mesh); !status) return status.error();
  return mesh;
}

template <class T, int D>
Result<std::vector<SimplexMesh<D>>> extract(const FieldView<const T, D>& field,
                                            std::span<const double> isovalues,
                                            const ExtractOptions& options) {
  ExtractOptions each = options;
  Workspace workspace;
  FieldRanges ranges;
  if (!each.workspace) each.workspace = &workspace;
  if (!each.ranges && isovalues.size() > 1) each.ranges = &ranges;
  std::vector<SimplexMesh<D>> meshes;
  for (std::size_t i = 0; i < isovalues.size(); ++i) {
    if (options.progress)
      each.progress = [&](double share) {
        return options.progress((static_cast<double>(i) + share) / static_cast<double>(isovalues.size()));
      };
    Result<SimplexMesh<D>> mesh = extract(field, isovalues[i], each);
    if (!mesh) return mesh.error();
    each.memory_limit -= std::min(each.memory_limit, memory_of(*mesh));
    meshes.push_back(std::move(*mesh));
  }
  return meshes;
}

#define HYPERISO_INSTANTIATE_EXTRACT(T, D)                                                                   \
  template Status extract_into(const FieldView<const T, D>&, double, const ExtractOptions&,                  \
                               SimplexMesh<D>&);                                                             \
  template Result<SimplexMesh<D>> extract(const FieldView<const T, D>&, double, const ExtractOptions&);      \
  template Result<std::vector<SimplexMesh<D>>> extract(const FieldView<const T, D>&,                         \
                                                       std::span<const double>, const ExtractOptions&);
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 2)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 3)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 4)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 5)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 6)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 7)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_EXTRACT, 8)

} // namespace hyperiso
