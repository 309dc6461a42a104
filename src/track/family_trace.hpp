#pragma once
// The cells that a family passes, found from cell to cell and from slab to slab; and what tracking needs of
// them.

#include "core/text.hpp"
#include "track/cell_links.hpp"
#include "track/sweep.hpp"

#include <deque>
#include <map>

namespace hyperiso::track_detail {

// By the method `hull` (or `component`). Sets of slots (cell_edges.hpp) are bits.
template <int D>
class CellPieces {
 public:
  static constexpr int space = D - 1;
  static constexpr unsigned time_bit = 1u << space, columns = 1u << space;
  using Slots = std::uint32_t;

  explicit CellPieces(const MarchTable<D>& table, const MarchTable<D - 1>& table_at_step)
      : table_(table), of_code_(MarchTable<D>::codes) {
    for (unsigned upper = 1; upper < 1u << D; ++upper)
      for (int axis = 0; axis < D; ++axis)
        if (upper >> axis & 1) add_edge(upper & ~(1u << axis), upper);
    for (unsigned upper = 1; upper < 1u << D; ++upper)
      for (int axis = 0; axis < D; ++axis)
        if (upper >> axis & 1) mirror_edge(upper & ~(1u << axis), upper);
    for (std::uint32_t code = 0; code < MarchTable<D - 1>::codes; ++code)
      add_step_pieces(table_at_step, code);
  }

  // The slots of the piece that each slot of a code belongs to.
  const std::array<Slots, 32>& pieces(std::uint32_t code) {
    if (!of_code_[code]) of_code_[code] = make_pieces(code);
    return *of_code_[code];
  }
  // The pieces that a cell has at its lower step.
  const std::vector<Slots>& pieces_at_lower_step(std::uint32_t code) const {
    unsigned at_step = 0; // the code of the cell of space, of the columns without their upper halves
    constexpr unsigned half = 1u << (space - 1);
    for (unsigned column = 0; column < 2; ++column)
      at_step |= (code >> (2 * half * column) & ((1u << half) - 1)) << (half * column);
    return at_step_[at_step];
  }

  // Whether of all cells around an edge within a step it is this one that lists it: the one where it lies at
  // the lowest corner, or next to that where the domain ends. `ends`: a bit for each axis of space along
  // which no cell follows.
  bool lists(unsigned slot, unsigned ends) const { return (far_sides_[slot] & ~ends) == 0; }

  Slots beside(int axis, unsigned side) const { return beside_[axis][side]; } // in that facet of the cell
  unsigned mirrored(int axis, unsigned slot) const { return mirrored_[axis][slot]; } // in the cell behind it
  unsigned slot_of_column(unsigned corner) const { return slot_of_column_[corner]; } // of an edge along time
  Slots along_time() const { return along_time_; }

 private:
  using Edges = CellEdges<D, Method::hull>;
  static_assert(Edges::slots <= 32);

  void add_edge(unsigned lower, unsigned upper) {
    const unsigned slot = Edges::slot(lower, upper);
    for (int axis = 0; axis < D; ++axis)
      if ((lower >> axis & 1) == (upper >> axis & 1)) beside_[axis][lower >> axis & 1] |= Slots{1} << slot;
    far_sides_[slot] = static_cast<std::uint8_t>(lower & (time_bit - 1));
    if ((lower ^ upper) == time_bit) {
      slot_of_column_[lower] = slot;
      along_time_ |= Slots{1} << slot;
    }
  }
  void mirror_edge(unsigned lower, unsigned upper) {
    for (int axis = 0; axis < D; ++axis)
      if ((lower >> axis & 1) == (upper >> axis & 1))
        mirrored_[axis][Edges::slot(lower, upper)] =
            static_cast<std::uint8_t>(Edges::slot(lower ^ 1u << axis, upper ^ 1u << axis));
  }

  // Which of `corners`, `each` to a simplex, hang together.
  static void unite(std::span<const std::uint8_t> corners, std::size_t each, std::array<Slots, 32>& piece) {
    for (std::size_t first = 0; first < corners.size(); first += each) {
      Slots together = 0;
      for (std::size_t i = 0; i < each; ++i)
        together |= Slots{1} << corners[first + i] | piece[corners[first + i]];
      for (Slots rest = together; rest != 0; rest &= rest - 1)
        piece[static_cast<std::size_t>(std::countr_zero(rest))] = together;
    }
  }
  std::unique_ptr<std::array<Slots, 32>> make_pieces(std::uint32_t code) const {
    auto piece = std::make_unique<std::array<Slots, 32>>();
    unite(std::span(table_.corners).subspan(table_.first[code], table_.first[code + 1] - table_.first[code]),
          D, *piece);
    return piece;
  }
  void add_step_pieces(const MarchTable<D - 1>& table, std::uint32_t code) {
    using StepEdges = CellEdges<D - 1, Method::hull>;
    std::array<std::uint8_t, 256> slot_in_cell{};
    for (unsigned upper = 1; upper < columns; ++upper)
      for (int axis = 0; axis < space; ++axis)
        if (upper >> axis & 1)
          slot_in_cell[StepEdges::slot(upper & ~(1u << axis), upper)] =
              static_cast<std::uint8_t>(Edges::slot(upper & ~(1u << axis), upper));
    std::vector<std::uint8_t> corners;
    for (std::size_t corner = table.first[code]; corner < table.first[code + 1]; ++corner)
      corners.push_back(slot_in_cell[table.corners[corner]]);
    std::array<Slots, 32> piece{};
    unite(corners, space, piece);
    std::vector<Slots>& pieces = at_step_[code];
    for (const Slots slots : piece)
      if (slots != 0 && std::ranges::find(pieces, slots) == pieces.end()) pieces.push_back(slots);
  }

  const MarchTable<D>& table_;
  std::array<std::array<Slots, 2>, D> beside_{};
  std::array<std::array<std::uint8_t, 32>, D> mirrored_{};
  std::array<unsigned, columns> slot_of_column_{};
  std::array<std::uint8_t, 32> far_sides_{}; // axes along which a slot lies at the far side of the cell
  Slots along_time_ = 0;
  std::vector<std::unique_ptr<std::array<Slots, 32>>> of_code_;
  std::array<std::vector<Slots>, MarchTable<D - 1>::codes> at_step_;
};

// The cells between two steps by their samples.
template <class T, int D>
class SampledCells final : public SignedCells<D> {
 public:
  SampledCells(const MarchTable<D>& table, const FieldView<const T, D>& slab, double isovalue, Inside inside)
      : SignedCells<D>(table, slab.dims()), slab_(slab), isovalue_(isovalue), above_(isovalue),
        below_(isovalue), is_above_(inside == Inside::above) {
    for (unsigned bit = 0; bit < 1u << D;
         ++bit) { // of a code: columns of places along the axes but the first
      offset_[bit] = (bit >> (D - 1) & 1) * slab.strides[0];
      for (int axis = 1; axis < D; ++axis) offset_[bit] += (bit >> (axis - 1) & 1) * slab.strides[axis];
      for (unsigned position = 0; position < D; ++position)
        if (!(bit >> position & 1)) near_bits_[position] |= std::uint32_t{1} << bit;
    }
  }

  // The code of the cell at `lowest`, or nothing if a sample is missing.
  std::optional<std::uint32_t> code_at(const T* lowest) const {
    std::uint32_t code = 0;
    bool missing = false;
    for (unsigned bit = 0; bit < 1u << D; ++bit) missing |= add_bit(lowest, bit, code);
    if (missing) return std::nullopt;
    return code;
  }
  // The same for a cell on one side of another, of which the code is known, along an axis.
  std::optional<std::uint32_t> code_beside(std::uint32_t known, int axis, unsigned side,
                                           const T* lowest) const {
    const unsigned position = axis == 0 ? D - 1 : axis - 1; // of the axis, in the number of a bit
    const std::uint32_t near = near_bits_[position];
    std::uint32_t code = side == 1 ? known >> (1u << position) & near : (known & near) << (1u << position);
    bool missing = false;
    for (std::uint32_t rest = side == 1 ? ~near & all_bits : near; rest != 0; rest &= rest - 1)
      missing |= add_bit(lowest, static_cast<unsigned>(std::countr_zero(rest)), code);
    if (missing) return std::nullopt;
    return code;
  }
  double time_from(const T* lower) const {
    return crossing(static_cast<double>(*lower), static_cast<double>(lower[slab_.strides[D - 1]]), isovalue_);
  }
  const FieldView<const T, D>& slab() const { return slab_; }
  std::uint32_t code_of(std::uint64_t cell) const override {
    return *code_at(&slab_.at(this->lowest_sample(cell)));
  }

 private:
  static constexpr std::uint32_t all_bits = static_cast<std::uint32_t>((std::uint64_t{1} << (1u << D)) - 1);

  // Returns whether the sample is missing.
  bool add_bit(const T* lowest, unsigned bit, std::uint32_t& code) const {
    const T value = lowest[offset_[bit]];
    code |= static_cast<std::uint32_t>(is_inside(value)) << bit;
    return is_missing(value);
  }
  bool is_inside(T value) const { return is_above_ ? above_.inside(value) : below_.inside(value); }
  bool inside(const std::array<std::int64_t, D>& sample) const override {
    return is_inside(slab_.at(sample));
  }
  double time_between(const std::array<std::int64_t, D>& lower) const override {
    return time_from(&slab_.at(lower));
  }

  FieldView<const T, D> slab_;
  double isovalue_;
  SignRule<T, true> above_;
  SignRule<T, false> below_;
  bool is_above_;
  std::array<std::int64_t, 1 << D> offset_{};
  std::array<std::uint32_t, D>
      near_bits_{}; // of a code: the samples at the near side, by the bit of the axis
};

// The families through some cells, in a field with no missing samples and none that make ties near them.
template <class T, int D>
class FamilyTrace {
 public:
  FamilyTrace(StepSource& source, double isovalue, const ExtractOptions& options)
      : source_(source), isovalue_(isovalue), options_(options), steps_(source.info().axes.back().count),
        table_(march_table<D>(options.method, {})), pieces_(table_, march_table<D - 1>(options.method, {})),
        links_(CellLinks<D>::of(options.method)), pole_table_(space) {
    for (int axis = 0; axis < D; ++axis)
      dims_[axis] = source.info().axes[static_cast<std::size_t>(axis)].count;
  }

  // Follows the surface from all of it that passes a cell, which must lie on the grid. False if it does not
  // pass there, or if this is no field for it.
  Result<bool> add_cell(const std::vector<std::int64_t>& cell) {
    Index at;
    for (std::size_t axis = 0; axis < space; ++axis) at[axis] = static_cast<std::int32_t>(cell[axis]);
    auto slab = slab_at(cell[D - 1]);
    if (!slab) return slab.error();
    const std::size_t number = visit(**slab, at);
    if (number == none) return false;
    Slots all = 0;
    for (const Slots piece : pieces_.pieces((*slab)->cells[number].code)) all |= piece;
    take(cell[D - 1], **slab, number, all);
    pending_[cell[D - 1]]; // whatever it has at the steps
    return all != 0;
  }

  // Until no slab has anything that its neighbours do not know. False as above.
  Result<bool> follow() {
    while (!pending_.empty()) {
      const std::int64_t step = pending_.begin()->first;
      const auto requests = std::move(pending_.begin()->second);
      pending_.erase(pending_.begin());
      auto slab = slab_at(step);
      if (!slab) return slab.error();
      (*slab)->number_of_cell.reserve(2 * requests.size());
      for (const Request& request : requests) {
        const std::size_t number = visit(**slab, request.at);
        if (number == none) return false;
        take(step, **slab, number, request.slots, request.slots);
      }
      if (!follow_in_slab(step, **slab)) return false;
      std::uint64_t bytes = 0;
      for (const auto& [at, traced] : slabs_) bytes += traced.cells.size() * (sizeof(TracedCell) + 32);
      if (bytes > options_.memory_limit)
        return Error{Code::out_of_memory, text("the cells passed so far take ", bytes,
                                               " bytes, the limit is ", options_.memory_limit)};
    }
    return true;
  }

  // Between which steps there is something: the first, and one past the last.
  std::pair<std::int64_t, std::int64_t> slabs() const {
    if (slabs_.empty()) return {0, 0};
    return {slabs_.begin()->first, slabs_.rbegin()->first + 1};
  }
  std::uint64_t samples() const { return visited_ << D; }

  struct Made {
    std::unique_ptr<Sweep<D>> sweep;
    std::shared_ptr<const StepPieces> pieces; // at the lower step
    std::shared_ptr<const StepPieces> upper_pieces;
  };
  // What lies between two steps; no sweep if there are ties. Requires a slab with something in it.
  Made make(std::int64_t step, double lower_time, double upper_time) {
    SlabTrace& slab = slabs_.at(step);
    Made made;
    made.pieces = pieces_at(slab, false);
    made.upper_pieces = step + 2 == steps_ ? pieces_at(slab, true) : nullptr;
    std::optional<std::vector<GridEdge>> candidates = find_candidates(slab);
    if (!candidates) return made;
    auto cells =
        std::make_unique<SampledCells<T, D>>(table_, slab.samples->slab(), isovalue_, options_.inside);
    Slab<D> unfolding{std::unique_ptr<SignedCells<D>>(std::move(cells))};
    describe(unfolding, SlabSamples<T, D>(slab.samples->slab(), isovalue_));
    made.sweep = std::make_unique<Sweep<D>>(std::move(unfolding), lower_time, upper_time, made.pieces,
                                            std::move(*candidates));
    return made;
  }

 private:
  static constexpr std::size_t space = D - 1;
  static constexpr std::size_t none = SIZE_MAX;
  using Slots = typename CellPieces<D>::Slots;
  using Index = std::array<std::int32_t, space>;

  struct TracedCell {
    Index at;
    std::uint32_t code;
    Slots taken;
    std::array<std::array<std::uint32_t, 2>, space> beside; // cells that the family goes on in, or nothing
  };
  static constexpr std::uint32_t nothing = UINT32_MAX;
  struct Request { // something that the slab beside has
    Index at;
    Slots slots;
  };
  struct SlabTrace {
    Field steps; // keeps the samples
    std::unique_ptr<SampledCells<T, D>> samples;
    NumberMap number_of_cell;
    std::vector<TracedCell> cells;
    std::vector<std::pair<std::uint32_t, Slots>> waiting; // cells, and what of them was taken
  };

  std::uint64_t cell_number(const Index& at) const {
    std::uint64_t number = 0;
    for (int axis = D - 2; axis >= 0; --axis)
      number = number * static_cast<std::uint64_t>(dims_[axis]) + static_cast<std::uint64_t>(at[axis]);
    return number;
  }
  const T* lowest_sample(const SlabTrace& slab, const Index& at) const {
    const FieldView<const T, D>& view = slab.samples->slab();
    const T* sample = view.samples;
    for (std::size_t axis = 0; axis < space; ++axis) sample += at[axis] * view.strides[axis];
    return sample;
  }

  Result<SlabTrace*> slab_at(std::int64_t step) {
    const auto [place, is_new] = slabs_.try_emplace(step);
    SlabTrace& slab = place->second;
    if (is_new) {
      auto steps = source_.read(step, step + 2);
      if (!steps) return steps.error();
      slab.steps = std::move(*steps);
      slab.samples = std::make_unique<SampledCells<T, D>>(table_, slab.steps.template view<T, D>(), isovalue_,
                                                          options_.inside);
    }
    return &slab;
  }

  // The number of a cell in the slab; none if a sample is missing.
  std::size_t visit(SlabTrace& slab, const Index& at) {
    return visit(slab, at, [&](const T* lowest) { return slab.samples->code_at(lowest); });
  }
  // `code_of(lowest)`: its code, if it is a new one.
  template <class CodeOf>
  std::size_t visit(SlabTrace& slab, const Index& at, CodeOf&& code_of) {
    const auto [number, is_new] =
        slab.number_of_cell.insert(cell_number(at), static_cast<std::uint32_t>(slab.cells.size()));
    if (!is_new) return number;
    ++visited_;
    const std::optional<std::uint32_t> code = code_of(lowest_sample(slab, at));
    if (!code) return none;
    TracedCell& cell = slab.cells.emplace_back(TracedCell{at, *code, 0, {}});
    for (auto& sides : cell.beside) sides.fill(nothing);
    return number;
  }
  // The same for the cell beside another one, which lies within the grid.
  std::size_t visit_beside(SlabTrace& slab, std::uint32_t from, std::size_t axis, unsigned side) {
    if (const std::uint32_t known = slab.cells[from].beside[axis][side]; known != nothing) return known;
    Index at = slab.cells[from].at;
    at[axis] += side == 1 ? 1 : -1;
    const std::size_t number = visit(slab, at, [&](const T* lowest) {
      return slab.samples->code_beside(slab.cells[from].code, static_cast<int>(axis), side, lowest);
    });
    if (number == none) return none;
    slab.cells[from].beside[axis][side] = static_cast<std::uint32_t>(number);
    slab.cells[number].beside[axis][1 - side] = from;
    return number;
  }

  // Takes the pieces of a cell that have one of the slots. `known`: of slots at a step, those that the slab
  // beside has.
  void take(std::int64_t step, SlabTrace& slab, std::size_t number, Slots slots, Slots known = 0) {
    TracedCell& cell = slab.cells[number];
    const auto& pieces = pieces_.pieces(cell.code);
    for (Slots rest = slots & ~cell.taken; rest != 0; rest &= ~cell.taken & (rest - 1)) {
      const Slots piece = pieces[static_cast<std::size_t>(std::countr_zero(rest))];
      cell.taken |= piece;
      slab.waiting.emplace_back(static_cast<std::uint32_t>(number), piece);
      if (step > 0) request(step - 1, cell.at, piece & pieces_.beside(D - 1, 0) & ~known);
      if (step + 2 < steps_) request(step + 1, cell.at, piece & pieces_.beside(D - 1, 1) & ~known);
    }
  }
  void request(std::int64_t step, const Index& at, Slots slots) {
    if (slots != 0) pending_[step].push_back({at, mirrored(D - 1, slots)});
  }
  Slots mirrored(int axis, Slots slots) const {
    Slots result = 0;
    for (; slots != 0; slots &= slots - 1)
      result |= Slots{1} << pieces_.mirrored(axis, static_cast<unsigned>(std::countr_zero(slots)));
    return result;
  }

  bool follow_in_slab(std::int64_t step, SlabTrace& slab) {
    while (!slab.waiting.empty()) {
      const auto [number, slots] = slab.waiting.back();
      slab.waiting.pop_back();
      for (int axis = 0; axis < D - 1; ++axis)
        for (unsigned side = 0; side < 2; ++side) {
          const Slots shared = slots & pieces_.beside(axis, side);
          if (shared == 0) continue;
          const auto along = static_cast<std::size_t>(axis);
          const std::int32_t index = slab.cells[number].at[along];
          if (side == 1 ? index == dims_[along] - 2 : index == 0) continue;
          const std::size_t other = visit_beside(slab, number, along, side);
          if (other == none) return false;
          take(step, slab, other, mirrored(axis, shared));
        }
    }
    return true;
  }

  // The pieces of the surface at the lower or the upper step, as far as they were taken.
  std::shared_ptr<const StepPieces> pieces_at(const SlabTrace& slab, bool upper) const {
    std::vector<Slots> pieces; // of the cells, one cell after the other
    std::vector<std::uint32_t> first;
    for (const TracedCell& cell : slab.cells) {
      first.push_back(static_cast<std::uint32_t>(pieces.size()));
      const Slots at_step = cell.taken & pieces_.beside(D - 1, upper ? 1 : 0);
      if (at_step == 0) continue;
      const Slots taken = upper ? mirrored(D - 1, at_step) : at_step;
      for (const Slots piece : pieces_.pieces_at_lower_step(upper ? upper_half(cell.code) : cell.code))
        if ((piece & taken) != 0) pieces.push_back(piece);
    }
    first.push_back(static_cast<std::uint32_t>(pieces.size()));

    UnionFind united(pieces.size());
    std::vector<GridEdge> edges; // on the lower step
    std::vector<std::uint32_t> piece_of_edge;
    for (std::size_t number = 0; number < slab.cells.size(); ++number) {
      const TracedCell& cell = slab.cells[number];
      unsigned ends = 0;
      for (std::size_t axis = 0; axis < space; ++axis)
        ends |= (cell.at[axis] == dims_[axis] - 2 ? 1u : 0u) << axis;
      for (std::uint32_t piece = first[number]; piece < first[number + 1]; ++piece) {
        for (std::size_t axis = 0; axis < space; ++axis) {
          const std::uint32_t other = cell.beside[axis][0];
          const Slots shared = pieces[piece] & pieces_.beside(static_cast<int>(axis), 0);
          if (other == nothing || shared == 0) continue;
          const Slots there = mirrored(static_cast<int>(axis), shared);
          for (std::uint32_t behind = first[other]; behind < first[other + 1]; ++behind)
            if ((pieces[behind] & there) != 0) united.unite(piece, behind);
        }
        for (Slots rest = pieces[piece]; rest != 0; rest &= rest - 1) {
          const auto slot = static_cast<unsigned>(std::countr_zero(rest));
          if (!pieces_.lists(slot, ends)) continue;
          edges.push_back(slab.samples->edge(cell_number(cell.at), slot));
          piece_of_edge.push_back(piece);
        }
      }
    }
    std::vector<std::uint32_t> name(pieces.size(), nothing); // of whole pieces: a vertex
    std::vector<std::uint32_t> piece(edges.size());
    for (std::uint32_t vertex = 0; vertex < edges.size(); ++vertex) {
      std::uint32_t& whole = name[united.find(piece_of_edge[vertex])];
      if (whole == nothing) whole = vertex;
      piece[vertex] = whole;
    }
    return std::make_shared<const StepPieces>(edges, piece, static_cast<GridEdge>(dims_[0]),
                                              static_cast<int>(space));
  }
  // The code whose lower step is the upper one of a code.
  static std::uint32_t upper_half(std::uint32_t code) {
    constexpr unsigned half = 1u << (space - 1);
    return code >> half;
  }

  // The edges along time of the taken pieces that are not told to be regular; nothing if one has a tie.
  std::optional<std::vector<GridEdge>> find_candidates(const SlabTrace& slab) {
    struct Crossing {
      GridEdge edge;
      double time;
      std::uint8_t present, poles;
    };
    NumberMap number_of_edge;
    number_of_edge.reserve(slab.cells.size());
    std::vector<Crossing> crossings;
    for (const TracedCell& cell : slab.cells) {
      if ((cell.taken & pieces_.along_time()) == 0) continue;
      const T* lowest = lowest_sample(slab, cell.at);
      unsigned taken = 0;
      std::array<std::uint32_t, CellPieces<D>::columns> number;
      std::array<double, CellPieces<D>::columns> time{};
      for (unsigned corner = 0; corner < CellPieces<D>::columns; ++corner) {
        const unsigned slot = pieces_.slot_of_column(corner);
        if (!(cell.taken >> slot & 1)) continue;
        taken |= 1u << corner;
        const GridEdge edge = slab.samples->edge(cell_number(cell.at), slot);
        const auto [found, is_new] =
            number_of_edge.insert(edge, static_cast<std::uint32_t>(crossings.size()));
        number[corner] = found;
        if (is_new) {
          const T* sample = lowest;
          unsigned present = 0;
          for (int axis = 0; axis < D - 1; ++axis) {
            const unsigned bit = corner >> axis & 1;
            sample += bit * slab.samples->slab().strides[axis];
            present |= PoleTable::present(axis, cell.at[axis] + bit, dims_[axis]);
          }
          crossings.push_back({edge, slab.samples->time_from(sample), static_cast<std::uint8_t>(present), 0});
          if (crossings.back().time == 0 || crossings.back().time == 1) return std::nullopt;
        }
        time[corner] = crossings[found].time;
      }
      links_.for_each_crossing(
          CellLinks<D>::signs_of(cell.code), taken, time,
          [&](unsigned corner, std::uint8_t poles) { crossings[number[corner]].poles |= poles; });
    }
    std::vector<GridEdge> candidates;
    for (const Crossing& crossing : crossings)
      if (!pole_table_.is_regular(crossing.present, crossing.poles)) candidates.push_back(crossing.edge);
    return candidates;
  }

  StepSource& source_;
  double isovalue_;
  ExtractOptions options_;
  std::int64_t steps_;
  std::array<std::int64_t, D> dims_{};
  const MarchTable<D>& table_;
  CellPieces<D> pieces_;
  const CellLinks<D>& links_;
  PoleTable pole_table_;
  std::map<std::int64_t, SlabTrace> slabs_;
  std::map<std::int64_t, std::vector<Request>> pending_; // of slabs
  std::uint64_t visited_ = 0;
};

} // namespace hyperiso::track_detail
