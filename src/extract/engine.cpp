#include "extract/engine.hpp"

#include "core/parallel.hpp"
#include "extract/barycentric.hpp"
#include "extract/missing.hpp"
#include "extract/slab_engine.hpp"
#include "extract/surface_memory.hpp"
#include "extract/units.hpp"
#include "extract/vertex_output.hpp"
#include "extract/workspace.hpp"

#include <atomic>

namespace hyperiso {
namespace {

// A unit's vertices that wait for their numbers.
struct Pending {
  std::size_t unit;
  std::uint64_t written; // of them, so far
  VertexBatch batch;
};

template <int D>
struct Worker {
  void* engine;
  Cells<D> cells;
  ScanMemory memory;
  MaskWindow window;              // if units are not linked
  std::vector<Pending> pending;   // the last is that of the current unit
  std::vector<VertexBatch> spare; // empty, to be used again

  // What it found. The memory is used again.
  void forget() {
    cells.run_count = cells.code_count = 0;
    cells.restarts.clear();
    window.last_layer = -1;
    pending.clear();
  }
};

// What an extraction leaves to the next.
template <int D>
struct EngineMemory final : Workspace::State::Memory {
  VertexNumbers numbers;
  std::vector<MaskWindow> windows; // if units are linked: one per block
  std::vector<Worker<D>> workers;
  std::vector<UnitCells> unit_cells;
};

template <int D, Method M>
class Engine {
 public:
  Engine(const Samples<D>& samples, TableForm form, const ExtractOptions& options,
         const EngineOptions& engine_options, SimplexMesh<D>& mesh)
      : samples_(samples), options_(options), engine_options_(engine_options), mesh_(mesh),
        grid_(samples.dims), workers_(worker_count(options.threads)),
        kernels_(kernels<D, M>(engine_options.instructions)),
        row_kernels_(row_kernels(samples.test.type, engine_options.instructions)),
        table_(march_table<D>(options.method, form)),
        memory_(options.workspace ? options.workspace->state().template of_dimension<D, EngineMemory<D>>()
                                  : own_memory_) {}

  // Of the whole field.
  Status run() {
    plan_ = plan_units(grid_, workers_, engine_options_.unit_samples);
    prepare_numbers();
    prepare_ranges();
    if (Status status = scan(); !status) return status;
    if (found_missing_) {
      present_ = find_present_cells(samples_, grid_, row_kernels_, workers_);
      if (Status status = scan(); !status) return status;
    }
    if (ranges_.low) options_.ranges->state().complete = true;
    number_planes();
    return emit();
  }

 protected: // for what extracts layer by layer
  using Edges = CellEdges<D, M>;

  // The share of the work that phase 1 is taken to be, for progress.
  static constexpr double scan_share = 0.7;

  void prepare_numbers() {
    memory_.numbers.plane_rows = plan_.linked && plan_.blocks > 1 ? grid_.halo : grid_.layer_rows;
    // A plane's vertices are counted in 32 bits.
    const auto most_in_row = static_cast<std::uint64_t>(grid_.dims[0]) * Edges::directions;
    if (static_cast<std::uint64_t>(memory_.numbers.plane_rows) > UINT32_MAX / most_in_row)
      memory_.numbers.plane_rows = 1;
    memory_.numbers.row_first.reset(static_cast<std::size_t>(grid_.rows) * Edges::directions);
    memory_.numbers.plane_first.reset(static_cast<std::size_t>(grid_.rows / memory_.numbers.plane_rows));
  }

  void prepare_ranges() {
    if (!options_.ranges || samples_.strides[0] != 1 || !samples_.levels.empty()) return;
    FieldRanges::State& ranges = options_.ranges->state();
    ranges_.known = ranges.hold(samples_);
    ranges_.low = static_cast<std::byte*>(ranges.low.data());
    ranges_.high = static_cast<std::byte*>(ranges.high.data());
  }

  // Phase 1 -----------------------------------------------------------------------------------------------

  Status scan() {
    const std::size_t units = plan_.units.size();
    ledger_.emplace(units);
    output_.emplace(mesh_, options_.precision == Precision::f64, options_.keep_edges, options_.memory_limit);
    memory_.unit_cells.assign(units, {});
    memory_.windows.resize(plan_.linked ? plan_.blocks : 0);
    for (MaskWindow& window : memory_.windows) window.last_layer = plan_.units.front().first_layer - 1;
    memory_.workers.resize(static_cast<std::size_t>(workers_));
    for (Worker<D>& worker : memory_.workers) worker.forget();
    vertices_ = simplices_ = active_cells_ = 0;
    found_missing_ = cancelled_ = false;
    next_unit_ = 0;
    run_workers(workers_, [&](int worker) {
      try {
        scan_units(static_cast<std::size_t>(worker));
      } catch (...) {
        ledger_->stop(); // the others may be waiting for this one
        throw;
      }
    });
    if (cancelled_) return cancelled();
    if (found_missing_) return {};
    if (!report(scan_share)) return cancelled();
    for (const UnitCells& unit : memory_.unit_cells) {
      vertices_ += unit.vertices;
      simplices_ += unit.simplices;
      active_cells_ += unit.active_cells;
    }
    return check_memory();
  }

  void scan_units(std::size_t worker_number) {
    Worker<D>& worker = memory_.workers[worker_number];
    worker.engine = this;
    for (std::size_t unit; (unit = next_unit_++) < plan_.units.size();) {
      if (const auto before = plan_.before(unit); before && !ledger_->wait_for(*before)) return;
      if (!scan_unit(worker, worker_number, unit)) return ledger_->stop();
      write_known(worker);
      if (worker_number == 0 &&
          !report(scan_share * static_cast<double>(unit + 1) / static_cast<double>(plan_.units.size())))
        return ledger_->stop();
      if (ledger_->stopped()) return;
    }
    while (!worker.pending.empty()) {
      if (!ledger_->wait_for_first_vertex(worker.pending.front().unit)) return;
      write_known(worker);
    }
  }

  bool scan_unit(Worker<D>& worker, std::size_t worker_number, std::size_t unit) {
    worker.pending.push_back({unit, 0, {}});
    if (!worker.spare.empty()) {
      worker.pending.back().batch = std::move(worker.spare.back());
      worker.spare.pop_back();
    }
    UnitCells& result = memory_.unit_cells[unit];
    result.worker = worker_number;
    MaskWindow& window = plan_.linked ? memory_.windows[plan_.units[unit].window] : worker.window;
    ScanJob<D> job{.samples = &samples_,
                   .grid = &grid_,
                   .row_kernels = &row_kernels_,
                   .present = &present_,
                   .table = &table_,
                   .wide_positions = options_.precision == Precision::f64,
                   .keep_edges = options_.keep_edges,
                   .first_row = first_row_,
                   .ranges = ranges_,
                   .given = engine_options_.given_masks,
                   .numbers = &memory_.numbers,
                   .unit = plan_.units[unit],
                   .window = &window,
                   .memory = &worker.memory,
                   .cells = &worker.cells,
                   .batch = &worker.pending.back().batch,
                   .owner = &worker,
                   .batch_is_large = [](void* owner) { write_current(*static_cast<Worker<D>*>(owner)); },
                   .result = &result,
                   .found_missing = false};
    kernels_.scan(job);
    if (job.found_missing) return found_missing_ = true, false;
    ledger_->finish(unit, result.vertices);
    return true;
  }

  // Writes the vertices of the current unit that there are so far, if all before them are counted.
  static void write_current(Worker<D>& worker) {
    Pending& current = worker.pending.back();
    const auto first = static_cast<Engine*>(worker.engine)->ledger_->first_vertex(current.unit);
    if (first) static_cast<Engine*>(worker.engine)->write(*first, current);
  }
  // The same for all its units, done with those.
  void write_known(Worker<D>& worker) {
    std::erase_if(worker.pending, [&](Pending& pending) {
      const auto first = ledger_->first_vertex(pending.unit);
      if (!first) return false;
      write(*first, pending);
      worker.spare.push_back(std::move(pending.batch));
      return true;
    });
  }
  void write(std::uint64_t first, Pending& pending) {
    const std::size_t count = pending.batch.count;
    output_->write(first + pending.written, pending.batch);
    pending.written += count;
  }

  // Between the phases ------------------------------------------------------------------------------------

  bool report(double share) {
    if (!options_.progress || options_.progress(share)) return true;
    cancelled_ = true;
    return false;
  }
  static Error cancelled() { return {Code::cancelled, "the extraction was cancelled"}; }

  Status check_memory() {
    wide_indices_ = engine_options_.wide_indices || first_vertex_ + vertices_ > UINT32_MAX;
    if (simplices_ > SIZE_MAX / (D * sizeof(std::uint64_t))) throw std::bad_alloc();
    const std::uint64_t needed =
        vertices_ * output_->bytes_per_vertex() + simplices_ * D * bytes_per_index(wide_indices_);
    if (Status fits = hyperiso::check_memory(vertices_, simplices_, needed, options_.memory_limit); !fits)
      return fits;
    output_->finish(vertices_);
    mesh_.active_cells = active_cells_;
    mesh_.simplices.reset(static_cast<std::size_t>(simplices_) * D, wide_indices_);
    return {};
  }

  // Planes count from their unit's first vertex so far.
  void number_planes() {
    for (std::size_t number = 0; number < plan_.units.size(); ++number) {
      const Unit& unit = plan_.units[number];
      const std::uint64_t first = first_vertex_ + *ledger_->first_vertex(number);
      for (std::int64_t layer = unit.first_layer; layer < unit.end_layer; ++layer)
        for (std::int64_t row = unit.first_row; row < unit.end_row; row += memory_.numbers.plane_rows)
          memory_.numbers.plane_first[static_cast<std::size_t>((layer * grid_.layer_rows + row) /
                                                               memory_.numbers.plane_rows)] += first;
    }
  }

  // Phase 2 -----------------------------------------------------------------------------------------------

  Status emit() {
    std::vector<std::uint64_t> first_simplex{0};
    for (const UnitCells& unit : memory_.unit_cells)
      first_simplex.push_back(first_simplex.back() + unit.simplices);
    const std::size_t units = memory_.unit_cells.size();
    share_out(workers_, units, [&](int worker, std::size_t unit) {
      if (cancelled_) return;
      emit_unit(memory_.unit_cells[unit], first_simplex[unit]);
      const double share = static_cast<double>(unit + 1) / static_cast<double>(units);
      if (worker == 0) report(scan_share + (1 - scan_share) * share);
    });
    if (cancelled_ || !report(1)) return cancelled();
    return {};
  }

  void emit_unit(const UnitCells& unit, std::uint64_t first_simplex) {
    if (unit.simplices == 0) return;
    auto* corners =
        static_cast<std::byte*>(mesh_.simplices.data()) + first_simplex * D * bytes_per_index(wide_indices_);
    const EmitJob<D> job{.grid = &grid_,
                         .table = &table_,
                         .numbers = &memory_.numbers,
                         .cells = &memory_.workers[unit.worker].cells,
                         .unit = &unit,
                         .corners = corners};
    wide_indices_ ? kernels_.emit_wide(job) : kernels_.emit_narrow(job);
  }

  const Samples<D>& samples_;
  const ExtractOptions& options_;
  const EngineOptions& engine_options_;
  SimplexMesh<D>& mesh_;
  const RowGrid<D> grid_;
  const int workers_;
  const Kernels<D, M> kernels_;
  const RowKernels row_kernels_;
  const MarchTable<D>& table_;
  EngineMemory<D> own_memory_; // if there is none to use again
  EngineMemory<D>& memory_;

  UnitPlan<D> plan_;               // of the layers to scan
  std::int64_t first_row_ = 0;     // number of row 0 in the whole field
  std::uint64_t first_vertex_ = 0; // vertices before those of these layers
  PresentCells present_;
  NotedRanges ranges_;
  std::optional<Ledger> ledger_;
  std::optional<VertexOutput> output_;
  std::atomic<std::size_t> next_unit_ = 0;
  std::atomic<bool> found_missing_ = false, cancelled_ = false;
  std::uint64_t vertices_ = 0, simplices_ = 0, active_cells_ = 0;
  bool wide_indices_ = false;
};

// Three layers, of which the last two are in memory: layer 1 is the lower step of the slab and layer 2 the
// upper one; of the step before them, layer 0, it is enough to know that there was one, and where its cells
// had no NaN. For the first slab the layers are 0 and 1. So the loops see layers one after the other, as in a
// whole field.
template <int D>
struct Window {
  Samples<D> window;
};

template <int D, Method M>
class SlabRun final : private Window<D>, private Engine<D, M>, public SlabEngine<D> {
 public:
  SlabRun(const Samples<D>& field, TableForm form, const ExtractOptions& options,
          const EngineOptions& engine_options, SimplexMesh<D>& mesh)
      : Window<D>{with_layers(field)}, Engine<D, M>(Window<D>::window, form, options, engine_options, mesh),
        times_(field.coordinates[D - 1]) {}

  Status extract(const std::byte* lower, const std::byte* upper, const FollowingStep& following) override {
    place_window(lower, upper);
    const std::int64_t layer = lower_layer();
    this->plan_ = plan_layers(this->grid_, this->workers_, this->engine_options_.unit_samples,
                              layer == 0 ? 0 : 2, layer + 2);
    if (step_ == 0) this->prepare_numbers();
    if (!this->present_.all())
      if (Status status = find_present(layer + 1, upper, following); !status) return status;
    if (Status status = this->scan(); !status) return status;
    if (this->found_missing_) {
      if (Status status = begin_missing(lower, upper, following); !status) return status;
      if (Status status = this->scan(); !status) return status;
    }
    this->number_planes();
    if (Status status = this->emit(); !status) return status;
    this->first_vertex_ += this->vertices_;
    if (step_ > 0) forget_lower_layer();
    ++step_;
    return {};
  }

 private:
  static Samples<D> with_layers(Samples<D> field) {
    field.dims[D - 1] = 3;
    return field;
  }
  std::int64_t lower_layer() const { return step_ == 0 ? 0 : 1; }

  // How far a step lies behind another, in samples.
  std::int64_t distance(const std::byte* from, const std::byte* to) const {
    return (reinterpret_cast<std::intptr_t>(to) - reinterpret_cast<std::intptr_t>(from)) /
           static_cast<std::intptr_t>(this->window.sample_size);
  }

  void place_window(const std::byte* lower, const std::byte* upper) {
    Samples<D>& samples = this->window;
    const std::int64_t first_step = step_ - lower_layer();
    samples.strides[D - 1] = distance(lower, upper);
    const auto back = lower_layer() * samples.strides[D - 1] * static_cast<std::int64_t>(samples.sample_size);
    samples.first = reinterpret_cast<const std::byte*>(reinterpret_cast<std::intptr_t>(lower) - back);
    samples.coordinates[D - 1].assign(3, times_.back());
    for (std::size_t layer = 0; layer < 3; ++layer)
      if (const std::size_t step = static_cast<std::size_t>(first_step) + layer; step < times_.size())
        samples.coordinates[D - 1][layer] = times_[step];
    this->first_row_ = first_step * this->grid_.layer_rows;
  }

  // The upper layer becomes the lower one.
  void forget_lower_layer() {
    for (MaskWindow& masks : this->memory_.windows) masks.swap_layers();
    const auto move_up = [](auto& numbers, int from, int to) {
      const std::size_t layer = numbers.size() / 3;
      std::copy_n(numbers.data() + static_cast<std::size_t>(from) * layer, layer,
                  numbers.data() + static_cast<std::size_t>(to) * layer);
    };
    move_up(this->memory_.numbers.row_first, 2, 1);
    move_up(this->memory_.numbers.plane_first, 2, 1);
    if (this->present_.all()) return;
    move_up(this->present_.words, 1, 0);
    move_up(this->present_.words, 2, 1);
  }

  // From the first NaN on, which cells have none is kept for the slab, and for those on both its sides: they
  // decide which edges within its steps carry a vertex.
  Status begin_missing(const std::byte* lower, const std::byte* upper, const FollowingStep& following) {
    const std::int64_t layer = lower_layer();
    this->present_.words.reset(static_cast<std::size_t>(this->grid_.rows * this->grid_.words));
    if (layer == 1) find_present(0, lower, lower); // as in the slab before, no sample was missing
    find_present(layer, lower, upper);
    return find_present(layer + 1, upper, following);
  }
  // Between the upper step of the slab and the following one; no cell if there is none.
  Status find_present(std::int64_t layer, const std::byte* upper, const FollowingStep& following) {
    const Result<const std::byte*> next = following();
    if (!next) return next.error();
    if (*next)
      find_present(layer, upper, *next);
    else
      std::fill_n(present_layer(layer), this->present_.words.size() / 3, 0);
    return {};
  }
  void find_present(std::int64_t layer, const std::byte* lower, const std::byte* upper) {
    Samples<D> samples = this->window;
    samples.first = lower;
    samples.dims[D - 1] = 2;
    samples.strides[D - 1] = distance(lower, upper);
    const PresentCells cells =
        find_present_cells(samples, RowGrid<D>(samples.dims), this->row_kernels_, this->workers_);
    std::copy_n(cells.words.data(), this->present_.words.size() / 3, present_layer(layer));
  }
  std::uint64_t* present_layer(std::int64_t layer) {
    return this->present_.words.data() + static_cast<std::size_t>(layer) * (this->present_.words.size() / 3);
  }

  const std::vector<double> times_; // of all steps
  std::int64_t step_ = 0;           // the lower one of the next slab
};

} // namespace

template <int D>
std::unique_ptr<SlabEngine<D>> make_slab_engine(const Samples<D>& field, TableForm form,
                                                const ExtractOptions& options,
                                                const EngineOptions& engine_options, SimplexMesh<D>& mesh) {
  if (options.method == Method::simplicial)
    return std::make_unique<SlabRun<D, Method::simplicial>>(field, form, options, engine_options, mesh);
  return std::make_unique<SlabRun<D, Method::hull>>(field, form, options, engine_options, mesh);
}

template <int D>
Status run_engine(const Samples<D>& samples, TableForm form, const ExtractOptions& options,
                  const EngineOptions& engine_options, SimplexMesh<D>& mesh) {
  if (options.method == Method::barycentric) return extract_barycentric(samples, form, options, mesh);
  if (options.method == Method::simplicial)
    return Engine<D, Method::simplicial>(samples, form, options, engine_options, mesh).run();
  // Both methods that are left have vertices on the same edges; only their tables differ.
  return Engine<D, Method::hull>(samples, form, options, engine_options, mesh).run();
}

template Status run_engine(const Samples<2>&, TableForm, const ExtractOptions&, const EngineOptions&,
                           SimplexMesh<2>&);
template Status run_engine(const Samples<3>&, TableForm, const ExtractOptions&, const EngineOptions&,
                           SimplexMesh<3>&);
template Status run_engine(const Samples<4>&, TableForm, const ExtractOptions&, const EngineOptions&,
                           SimplexMesh<4>&);
template Status run_engine(const Samples<5>&, TableForm, const ExtractOptions&, const EngineOptions&,
                           SimplexMesh<5>&);

template std::unique_ptr<SlabEngine<2>> make_slab_engine(const Samples<2>&, TableForm, const ExtractOptions&,
                                                         const EngineOptions&, SimplexMesh<2>&);
template std::unique_ptr<SlabEngine<3>> make_slab_engine(const Samples<3>&, TableForm, const ExtractOptions&,
                                                         const EngineOptions&, SimplexMesh<3>&);
template std::unique_ptr<SlabEngine<4>> make_slab_engine(const Samples<4>&, TableForm, const ExtractOptions&,
                                                         const EngineOptions&, SimplexMesh<4>&);
template std::unique_ptr<SlabEngine<5>> make_slab_engine(const Samples<5>&, TableForm, const ExtractOptions&,
                                                         const EngineOptions&, SimplexMesh<5>&);

} // namespace hyperiso
