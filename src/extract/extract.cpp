#include "hyperiso/extract.hpp"

#include "core/text.hpp"
#include "extract/extract_with.hpp"

#include <new>

namespace hyperiso {

template <class T, int D>
Status extract_into(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                    SimplexMesh<D>& mesh) {
  if (!std::isfinite(isovalue))
    return Error{Code::invalid_isovalue, text("the isovalue is ", isovalue, "; it must be a finite number")};
  if (options.threads < 0)
    return Error{Code::invalid_argument,
                 text("the number of threads is ", options.threads, "; it must be positive, or 0 for all")};
  try {
    return extract_with(field, isovalue, options, EngineOptions{}, mesh);
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

#define HYPERISO_INSTANTIATE_EXTRACT(T, D)                                                                   \
  template Status extract_into(const FieldView<const T, D>&, double, const ExtractOptions&,                  \
                               SimplexMesh<D>&);                                                             \
  template Result<SimplexMesh<D>> extract(const FieldView<const T, D>&, double, const ExtractOptions&);
#define HYPERISO_INSTANTIATE_TYPES(D)                                                                        \
  HYPERISO_INSTANTIATE_EXTRACT(std::uint8_t, D)                                                              \
  HYPERISO_INSTANTIATE_EXTRACT(std::int8_t, D)                                                               \
  HYPERISO_INSTANTIATE_EXTRACT(std::uint16_t, D)                                                             \
  HYPERISO_INSTANTIATE_EXTRACT(std::int16_t, D)                                                              \
  HYPERISO_INSTANTIATE_EXTRACT(std::uint32_t, D)                                                             \
  HYPERISO_INSTANTIATE_EXTRACT(std::int32_t, D)                                                              \
  HYPERISO_INSTANTIATE_EXTRACT(float, D)                                                                     \
  HYPERISO_INSTANTIATE_EXTRACT(double, D)

HYPERISO_INSTANTIATE_TYPES(2)
HYPERISO_INSTANTIATE_TYPES(3)
HYPERISO_INSTANTIATE_TYPES(4)

} // namespace hyperiso
