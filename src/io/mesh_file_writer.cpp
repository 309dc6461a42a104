// Meshes that come in pieces. Their arrays go to temporary files as they are; at the end these files, mapped
// into memory, are the arrays of one mesh, and the writer of the format sees nothing new.

#include "core/text.hpp"
#include "io/mesh_formats.hpp"

#include <algorithm>
#include <new>
#include <optional>
#include <sys/mman.h>
#include <vector>

namespace hyperiso {

struct MeshFileWriter::Parts {
  Parts(int dimension, int simplex_dimension, std::filesystem::path path_, WriteMeshOptions options_,
        AtomicFile positions_, AtomicFile simplices_)
      : path(std::move(path_)), options(std::move(options_)), mesh(dimension, simplex_dimension),
        positions(std::move(positions_)), simplices(std::move(simplices_)) {}

  std::filesystem::path path;
  WriteMeshOptions options;
  Mesh mesh; // what is known of the whole: no arrays
  AtomicFile positions;
  std::optional<AtomicFile> simplices, edges;
  bool started = false, wide_positions = false, wide_simplices = false;
  std::uint64_t vertices = 0, corners = 0;

  Status start(const Mesh& piece);
  Status check(const Mesh& piece) const;
  Status append_simplices(const IndexArray& piece);
  Status widen_simplices();
  Result<Mesh> joined();
};

namespace {

template <class To, class From>
void write_converted(AtomicFile& file, std::span<From> numbers) {
  std::vector<To> block;
  for (std::size_t start = 0; start < numbers.size() && !file.failed(); start += block.size()) {
    const std::size_t count = std::min<std::size_t>(numbers.size() - start, 1 << 15);
    block.assign(numbers.begin() + static_cast<std::ptrdiff_t>(start),
                 numbers.begin() + static_cast<std::ptrdiff_t>(start + count));
    file.write(block.data(), block.size() * sizeof(To));
  }
}

// Gives back the pages of arrays that were looked at: they can be read again.
class Pages {
 public:
  template <class Numbers>
  void add(Numbers& numbers, std::size_t bytes) {
    if (bytes > 0) arrays_.push_back({numbers.data(), bytes});
  }
  void release() const {
    for (const auto& [data, bytes] : arrays_) madvise(data, bytes, MADV_DONTNEED);
  }

 private:
  struct Range {
    void* data;
    std::size_t bytes;
  };
  std::vector<Range> arrays_;
};

} // namespace

Status MeshFileWriter::Parts::start(const Mesh& piece) {
  started = true;
  wide_positions = piece.positions.wide();
  mesh.grid_axes = piece.grid_axes;
  if (!options.keep_edges || piece.grid_axes.empty() || piece.edges.size() != piece.vertex_count()) return {};
  auto file = AtomicFile::create_scratch(path);
  if (!file) return file.error();
  edges.emplace(std::move(*file));
  return {};
}

// A file that contradicts itself could crash the program that reads it.
Status MeshFileWriter::Parts::check(const Mesh& piece) const {
  const auto wrong = [](const auto&... pieces) { return Error{Code::invalid_argument, text(pieces...)}; };
  if (piece.dimension != mesh.dimension || piece.simplex_dimension != mesh.simplex_dimension)
    return wrong("a piece has ", piece.simplex_dimension, "-simplices in ", piece.dimension,
                 " dimensions, the mesh ", mesh.simplex_dimension, "-simplices in ", mesh.dimension);
  if (piece.positions.wide() != wide_positions)
    return wrong("the positions of a piece are ", piece.positions.wide() ? "f64" : "f32",
                 ", those before it are not");
  if (piece.positions.size() != piece.vertex_count() * static_cast<std::size_t>(piece.dimension) ||
      piece.simplices.size() != piece.simplex_count() * static_cast<std::size_t>(piece.simplex_dimension + 1))
    return wrong("a piece ends within a vertex or a simplex");
  if (edges && piece.edges.size() != piece.vertex_count())
    return wrong("a piece has ", piece.edges.size(), " grid edges for ", piece.vertex_count(), " vertices");
  if (!piece.attributes.empty())
    return wrong("attributes, such as \"", piece.attributes[0].name, "\", cannot be written piece by piece");
  const std::uint64_t known = vertices + piece.vertex_count();
  const bool in_range = piece.simplices.visit([&](auto numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [&](auto vertex) { return vertex < known; });
  });
  if (!in_range) return wrong("a simplex uses a vertex that the ", known, " so far do not hold");
  return {};
}

Status MeshFileWriter::Parts::append_simplices(const IndexArray& piece) {
  if (piece.wide() && !wide_simplices)
    if (Status status = widen_simplices(); !status) return status;
  if (piece.wide() == wide_simplices)
    simplices->write(piece.data(), piece.bytes());
  else
    piece.visit([&](auto numbers) { write_converted<std::uint64_t>(*simplices, numbers); });
  corners += piece.size();
  return simplices->status();
}

Status MeshFileWriter::Parts::widen_simplices() {
  auto narrow = simplices->read_back();
  if (!narrow) return narrow.error();
  auto file = AtomicFile::create_scratch(path);
  if (!file) return file.error();
  const auto* numbers = static_cast<const std::uint32_t*>(narrow->data());
  write_converted<std::uint64_t>(*file, std::span(numbers, static_cast<std::size_t>(corners)));
  simplices.emplace(std::move(*file));
  wide_simplices = true;
  return simplices->status();
}

Result<Mesh> MeshFileWriter::Parts::joined() {
  auto position_bytes = positions.read_back();
  if (!position_bytes) return position_bytes.error();
  auto simplex_bytes = simplices->read_back();
  if (!simplex_bytes) return simplex_bytes.error();
  mesh.positions.take(std::move(*position_bytes), wide_positions);
  mesh.simplices.take(std::move(*simplex_bytes), wide_simplices);
  if (edges) {
    auto edge_bytes = edges->read_back();
    if (!edge_bytes) return edge_bytes.error();
    mesh.edges.take(std::move(*edge_bytes));
  }
  return std::move(mesh);
}

MeshFileWriter::MeshFileWriter(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
MeshFileWriter::MeshFileWriter(MeshFileWriter&&) noexcept = default;
MeshFileWriter& MeshFileWriter::operator=(MeshFileWriter&&) noexcept = default;
MeshFileWriter::~MeshFileWriter() = default;

Result<MeshFileWriter> MeshFileWriter::create(int dimension, int simplex_dimension,
                                              const std::filesystem::path& path,
                                              const WriteMeshOptions& options) {
  if (const Status fits = check_mesh_format(dimension, simplex_dimension, path, options); !fits)
    return fits.error();
  try {
    auto positions = AtomicFile::create_scratch(path);
    if (!positions) return positions.error();
    auto simplices = AtomicFile::create_scratch(path);
    if (!simplices) return simplices.error();
    return MeshFileWriter(std::make_unique<Parts>(dimension, simplex_dimension, path, options,
                                                  std::move(*positions), std::move(*simplices)));
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

Status MeshFileWriter::append(const Mesh& piece) {
  Parts& parts = *parts_;
  try {
    if (!parts.started)
      if (Status status = parts.start(piece); !status) return status;
    if (Status status = parts.check(piece); !status) return status;
    parts.mesh.active_cells += piece.active_cells;
    parts.vertices += piece.vertex_count();
    parts.positions.write(piece.positions.data(), piece.positions.bytes());
    if (Status status = parts.positions.status(); !status) return status;
    if (parts.edges) {
      parts.edges->write(piece.edges.data(), piece.edges.size() * sizeof(GridEdge));
      if (Status status = parts.edges->status(); !status) return status;
    }
    return parts.append_simplices(piece.simplices);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(parts.path);
  }
}

Status MeshFileWriter::finish() {
  try {
    auto mesh = parts_->joined();
    if (!mesh) return mesh.error();
    Pages pages;
    pages.add(mesh->positions, mesh->positions.bytes());
    pages.add(mesh->simplices, mesh->simplices.bytes());
    pages.add(mesh->edges, mesh->edges.size() * sizeof(GridEdge));
    return write_checked_mesh(*mesh, parts_->path, parts_->options, [&] { pages.release(); });
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(parts_->path);
  }
}

} // namespace hyperiso
