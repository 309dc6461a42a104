#include "hyperiso/extract.hpp"

#include "core/text.hpp"
#include "extract/reference.hpp"

#include <new>

namespace hyperiso {

template <class T, int D>
Result<SimplexMesh<D>> extract(const FieldView<const T, D>& field, double isovalue,
                               const ExtractOptions& options) {
  if (!std::isfinite(isovalue))
    return Error{Code::invalid_isovalue, text("the isovalue is ", isovalue, "; it must be a finite number")};
  try {
    return extract_reference(field, isovalue, options);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the surface"};
  }
}

#define HYPERISO_INSTANTIATE_EXTRACT(T, D)                                                                   \
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
