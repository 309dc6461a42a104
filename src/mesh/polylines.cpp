#include "hyperiso/polylines.hpp"

#include "core/text.hpp"

#include <algorithm>
#include <new>

namespace hyperiso {
namespace {

constexpr std::uint64_t none = UINT64_MAX;

// Where the segments lead: for each vertex the end of the one that begins there, and the beginning of the one
// that ends there.
struct Links {
  std::vector<std::uint64_t> next, previous;
};

Result<Links> link(const Mesh& mesh) {
  const std::size_t vertices = mesh.vertex_count();
  Links links{std::vector(vertices, none), std::vector(vertices, none)};
  for (std::size_t segment = 0; segment < mesh.simplex_count(); ++segment) {
    const std::uint64_t from = mesh.simplices[2 * segment], to = mesh.simplices[2 * segment + 1];
    if (from >= vertices || to >= vertices)
      return Error{Code::invalid_argument,
                   text("segment ", segment, " names a vertex beyond the ", vertices, " of the mesh")};
    if (links.next[from] != none || links.previous[to] != none)
      return Error{Code::invalid_argument,
                   text("vertex ", links.next[from] != none ? from : to,
                        " has two segments that begin or end there: these are no lines")};
    links.next[from] = to;
    links.previous[to] = from;
  }
  return links;
}

// The line from `first` on; takes its links away.
Polyline follow(Links& links, std::uint64_t first) {
  Polyline line;
  std::uint64_t vertex = first;
  do {
    line.vertices.push_back(vertex);
    vertex = std::exchange(links.next[vertex], none);
  } while (vertex != none && vertex != first);
  line.closed = vertex == first;
  return line;
}

} // namespace

Result<std::vector<Polyline>> polylines(const Mesh& mesh) {
  if (mesh.simplex_dimension != 1)
    return Error{Code::invalid_argument, text("lines are joined from segments; this is a mesh of ",
                                              mesh.simplex_dimension, "-simplices")};
  try {
    auto links = link(mesh);
    if (!links) return links.error();
    std::vector<Polyline> lines;
    const std::size_t vertices = mesh.vertex_count();
    for (std::uint64_t vertex = 0; vertex < vertices; ++vertex)
      if (links->previous[vertex] == none && links->next[vertex] != none)
        lines.push_back(follow(*links, vertex));
    for (std::uint64_t vertex = 0; vertex < vertices; ++vertex) // what is left is closed
      if (links->next[vertex] != none) lines.push_back(follow(*links, vertex));
    std::ranges::sort(lines, {}, [](const Polyline& line) { return line.vertices.front(); });
    return lines;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, text("not enough memory to join ", mesh.simplex_count(), " segments")};
  }
}

} // namespace hyperiso
