#pragma once
// The vertices of a mesh while nobody knows yet how many there will be.

#include "extract/kernels.hpp"
#include "extract/stream_copy.hpp"
#include "extract/surface_memory.hpp"

#include <mutex>
#include <shared_mutex>

namespace hyperiso {

// Workers write batches side by side; one that finds no room waits for the others, and makes it.
class VertexOutput {
 public:
  // `limit`: bytes that positions and edges may take.
  VertexOutput(Mesh& mesh, bool wide, bool keep_edges, std::uint64_t limit)
      : mesh_(mesh), keep_edges_(keep_edges),
        position_bytes_(hyperiso::bytes_per_vertex(mesh.dimension, wide, false)),
        bytes_per_vertex_(hyperiso::bytes_per_vertex(mesh.dimension, wide, keep_edges)),
        most_(limit / bytes_per_vertex_) {
    mesh_.positions.reset(0, wide);
    mesh_.edges.reset(0);
  }

  std::uint64_t bytes_per_vertex() const { return bytes_per_vertex_; }

  // Writes the batch from vertex `first` on and empties it. Beyond the limit nothing is written.
  void write(std::uint64_t first, VertexBatch& batch) {
    if (batch.count > 0 && first + batch.count <= most_) {
      make_room(static_cast<std::size_t>(first) + batch.count);
      const std::shared_lock lock(mutex_);
      auto* positions = static_cast<std::byte*>(mesh_.positions.data());
      stream_copy(positions + first * position_bytes_, batch.positions.data(), batch.count * position_bytes_);
      if (keep_edges_)
        stream_copy(mesh_.edges.data() + first, batch.edges.data(), batch.count * sizeof(GridEdge));
    }
    batch.count = 0;
  }
  void finish(std::uint64_t vertices) { resize(static_cast<std::size_t>(vertices)); }

 private:
  void make_room(std::size_t vertices) {
    {
      const std::shared_lock lock(mutex_);
      if (vertices <= room_) return;
    }
    const std::unique_lock lock(mutex_);
    if (vertices > room_) resize(vertices);
  }
  void resize(std::size_t vertices) {
    mesh_.positions.resize(vertices * static_cast<std::size_t>(mesh_.dimension));
    if (keep_edges_) mesh_.edges.resize(vertices);
    room_ = vertices;
  }

  Mesh& mesh_;
  const bool keep_edges_;
  const std::size_t position_bytes_;
  const std::uint64_t bytes_per_vertex_;
  const std::uint64_t most_;
  std::shared_mutex mutex_;
  std::size_t room_ = 0;
};

} // namespace hyperiso
