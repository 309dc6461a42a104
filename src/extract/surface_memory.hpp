#pragma once
// Whether a surface fits into the memory that it may take.

#include "core/text.hpp"
#include "hyperiso/extract.hpp"

namespace hyperiso {

// Bytes of a vertex in the mesh.
inline std::uint64_t bytes_per_vertex(int dimension, bool wide, bool keeps_edge) {
  return static_cast<std::uint64_t>(dimension) * (wide ? sizeof(double) : sizeof(float)) +
         (keeps_edge ? sizeof(GridEdge) : 0);
}

inline std::uint64_t bytes_per_index(bool wide) {
  return wide ? sizeof(std::uint64_t) : sizeof(std::uint32_t);
}

// Error: out_of_memory, if the surface takes more than the limit.
inline Status check_memory(std::uint64_t vertices, std::uint64_t simplices, std::uint64_t bytes,
                           std::uint64_t limit) {
  if (bytes <= limit) return {};
  return Error{Code::out_of_memory,
               text("the surface of ", vertices, " vertices and ", simplices, " simplices needs ",
                    byte_size(bytes), ", the limit is ", byte_size(limit))};
}

// For a surface of which only that much is known.
inline Error more_than_fits(std::uint64_t vertices, std::uint64_t simplices, std::uint64_t limit) {
  return {Code::out_of_memory, text("the surface, ", vertices, " vertices and ", simplices,
                                    " simplices so far, needs more than ", byte_size(limit))};
}

} // namespace hyperiso
