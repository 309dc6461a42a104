// The extraction of a page that holds a field: the library's own code, compiled to WebAssembly, behind
// functions that take numbers. viewer/src/worker.ts calls them, in the order in which they stand here.

#include "extract/barycentric.hpp"
#include "hyperiso/mesh.hpp"
#include "view/payload.hpp"
#include "view/surface_of_codes.hpp"
#include "view/world_axis.hpp"

#include <optional>

#define EXPORT(name) __attribute__((export_name(#name))) name

extern "C" __attribute__((import_module("page"), import_name("progress"))) void report_progress(double share);

namespace hyperiso {

// Not in the module: pages of surfaces by this method hold the mesh.
template <int D>
Status extract_barycentric(const Samples<D>&, TableForm, const ExtractOptions&, SimplexMesh<D>&) {
  return Error{Code::invalid_argument, {}};
}
template Status extract_barycentric(const Samples<3>&, TableForm, const ExtractOptions&, SimplexMesh<3>&);
template Status extract_barycentric(const Samples<4>&, TableForm, const ExtractOptions&, SimplexMesh<4>&);

namespace {

// What the page holds, and the surface extracted last.
struct State {
  std::vector<unsigned char> input;
  std::vector<Axis> axes;
  std::vector<double> minimum, maximum; // of the surface's coordinates along the axes
  std::optional<Affine> world;
  bool time_slabs = false;
  ExtractOptions options;
  std::optional<SampleLayers> layers;
  std::vector<std::uint16_t> levels;
  std::vector<std::uint32_t> simplices;
};
State state;

template <int D>
bool extract_here(double isovalue) {
  Grid<D> grid;
  for (int axis = 0; axis < D; ++axis) grid.axes[axis] = state.axes[static_cast<std::size_t>(axis)];
  SimplexMesh<D> mesh;
  if (!surface_of_codes(*state.layers, grid, isovalue, state.options, mesh)) return false;
  if (state.world) transform(mesh, *state.world);
  std::vector<Quantiser> quantisers;
  for (std::size_t k = 0; k < D; ++k)
    quantisers.push_back(
        quantiser_of(state.world ? world_axis(state.axes[k], *state.world, k) : state.axes[k],
                     state.minimum[k], state.maximum[k]));
  const Payload payload(mesh, std::move(quantisers), state.time_slabs);
  state.levels.resize(4 * payload.vertex_count());
  state.simplices.resize(4 * payload.simplex_count());
  payload.unpack(state.levels.data(), state.simplices.data());
  return true;
}

} // namespace
} // namespace hyperiso

using namespace hyperiso;

extern "C" {

// Room for what the next call reads.
unsigned char* EXPORT(room)(std::size_t bytes) {
  state.input.resize(bytes);
  return state.input.data();
}

// An axis of the grid, in their order; reads its coordinates if they are uneven.
void EXPORT(add_axis)(int count, double first, double origin, double spacing, int uneven, double minimum,
                      double maximum) {
  Axis axis;
  axis.count = count;
  axis.first = static_cast<std::int64_t>(first);
  axis.origin = origin;
  axis.spacing = spacing;
  const auto* coordinates = reinterpret_cast<const double*>(state.input.data());
  if (uneven) axis.coordinates.assign(coordinates, coordinates + count);
  state.axes.push_back(std::move(axis));
  state.minimum.push_back(minimum);
  state.maximum.push_back(maximum);
}

// Reads the rows of the linear map and then the offset.
void EXPORT(set_world)() {
  const std::size_t D = state.axes.size();
  const auto* numbers = reinterpret_cast<const double*>(state.input.data());
  state.world = Affine{{numbers, numbers + D * D}, {numbers + D * D, numbers + D * D + D}};
}

void EXPORT(set_samples)(int narrow, int special, int band, int inside_below, int first_class,
                         double isovalue, int time_slabs, int method) {
  CodeScale scale;
  scale.narrow = narrow;
  scale.special = special;
  scale.band = band;
  scale.inside = inside_below ? Inside::below : Inside::above;
  scale.isovalue = isovalue;
  std::vector<std::int64_t> dims;
  for (const Axis& axis : state.axes) dims.push_back(axis.count);
  state.layers.emplace(std::move(dims), scale, static_cast<SampleClass>(first_class));
  state.time_slabs = time_slabs;
  state.options.inside = scale.inside;
  state.options.method = static_cast<Method>(method);
  state.options.threads = 1;
  state.options.keep_edges = false;
  state.options.progress = [](double share) { return report_progress(share), true; };
}

// Reads the samples of the next layers; 0 if these are not theirs.
int EXPORT(add_layers)(int layers) { return state.layers->decode(layers, state.input); }

const std::uint16_t* EXPORT(codes)() { return state.layers->codes.data(); }
std::size_t EXPORT(code_count)() { return state.layers->codes.size(); }

// The surface; 0 if it failed.
int EXPORT(extract)(double isovalue) {
  return state.axes.size() == 3 ? extract_here<3>(isovalue) : extract_here<4>(isovalue);
}
const std::uint16_t* EXPORT(levels)() { return state.levels.data(); }
std::size_t EXPORT(vertex_count)() { return state.levels.size() / 4; }
const std::uint32_t* EXPORT(simplices)() { return state.simplices.data(); }
std::size_t EXPORT(simplex_count)() { return state.simplices.size() / 4; }

} // extern "C"
