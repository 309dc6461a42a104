#pragma once
// How the rows of a field are parted among workers, and in which order results are known.

#include "extract/kernels.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>

namespace hyperiso {

// The units of a field, in memory order.
//
// A unit needs the masks of the rows before it that its cells touch. There are two ways to have them:
// - linked: layers are parted into blocks of rows, a unit is a block of one or several layers, and it finds
//   the masks of the layer before in the window it shares with the unit on the same block there. For few
//   large layers.
// - not linked: a unit is some whole layers, and makes the masks of the layer before them again. For many
//   small layers.
template <int D>
struct UnitPlan {
  std::vector<Unit> units;
  std::size_t blocks = 1;
  bool linked = false;

  // The unit whose window `unit` continues; nothing if there is none.
  std::optional<std::size_t> before(std::size_t unit) const {
    if (!linked || unit < blocks) return std::nullopt;
    return unit - blocks;
  }
};

// A batch of a unit's vertices fits the second-level cache.
constexpr std::int64_t usual_unit_samples = 1 << 16;

// How many blocks to part a layer into, so that each has about `wanted` samples.
template <int D>
std::size_t blocks_of_layer(const RowGrid<D>& grid, int workers, std::int64_t wanted) {
  // A block makes the masks of the plane (`halo` rows) before it again: with 8 planes and more that costs
  // little.
  const std::int64_t planes = D > 2 ? grid.dims[D - 2] : 1;
  const std::int64_t most = std::min(planes / 8, grid.dims[0] * grid.layer_rows / wanted);
  return static_cast<std::size_t>(std::clamp<std::int64_t>(most, 1, 4 * workers));
}

// Adds the units of the layers [first, end), `unit_layers` each, to a plan whose blocks are known.
template <int D>
void add_units(UnitPlan<D>& plan, const RowGrid<D>& grid, std::int64_t first, std::int64_t end,
               std::int64_t unit_layers) {
  const auto bound = [&](std::size_t block) {
    if (plan.blocks == 1) return block == 0 ? std::int64_t{0} : grid.layer_rows;
    return grid.dims[D - 2] * static_cast<std::int64_t>(block) / static_cast<std::int64_t>(plan.blocks) *
           grid.halo;
  };
  for (std::int64_t layer = first; layer < end; layer += unit_layers)
    for (std::size_t block = 0; block < plan.blocks; ++block)
      plan.units.push_back(
          {layer, std::min(layer + unit_layers, end), bound(block), bound(block + 1), block});
}

// Of the whole field.
template <int D>
UnitPlan<D> plan_units(const RowGrid<D>& grid, int workers, std::int64_t unit_samples) {
  const std::int64_t wanted = unit_samples > 0 ? unit_samples : usual_unit_samples;
  const std::int64_t layers = grid.dims[D - 1], layer_samples = grid.dims[0] * grid.layer_rows;
  UnitPlan<D> plan;
  std::int64_t unit_layers = 1;
  if (workers == 1) {
    plan.linked = true;
    unit_layers = std::max<std::int64_t>(1, wanted / layer_samples);
  } else {
    plan.blocks = blocks_of_layer(grid, workers, wanted);
    plan.linked = plan.blocks > static_cast<std::size_t>(workers);
    if (!plan.linked) {
      plan.blocks = 1;
      const std::int64_t share = (layers + 8 * workers - 1) / (8 * workers);
      const std::int64_t halo_small = std::min<std::int64_t>(16, (layers + workers - 1) / workers);
      unit_layers = std::max(share, halo_small);
    }
  }
  add_units(plan, grid, 0, layers, unit_layers);
  return plan;
}

// Of the layers [first, end) alone, the masks of the layer before them being known.
template <int D>
UnitPlan<D> plan_layers(const RowGrid<D>& grid, int workers, std::int64_t unit_samples, std::int64_t first,
                        std::int64_t end) {
  UnitPlan<D> plan;
  plan.linked = true;
  if (workers > 1)
    plan.blocks = blocks_of_layer(grid, workers, unit_samples > 0 ? unit_samples : usual_unit_samples);
  add_units(plan, grid, first, end, 1);
  return plan;
}

// Which units are done, and how many vertices come before each. Safe to use from all workers.
class Ledger {
 public:
  explicit Ledger(std::size_t units) : vertices_(units), done_(units), first_(units + 1) {}

  void finish(std::size_t unit, std::uint64_t vertices) {
    const std::lock_guard lock(mutex_);
    vertices_[unit] = vertices;
    done_[unit] = true;
    while (known_ < done_.size() && done_[known_]) {
      first_[known_ + 1] = first_[known_] + vertices_[known_];
      ++known_;
    }
    changed_.notify_all();
  }
  // How many vertices come before the unit, if that is known by now.
  std::optional<std::uint64_t> first_vertex(std::size_t unit) {
    const std::lock_guard lock(mutex_);
    if (unit > known_) return std::nullopt;
    return first_[unit];
  }
  // Waits until the unit is done; false if the work was stopped instead.
  bool wait_for(std::size_t unit) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stopped_ || done_[unit]; });
    return !stopped_;
  }
  // The same until its first vertex is known.
  bool wait_for_first_vertex(std::size_t unit) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stopped_ || known_ >= unit; });
    return !stopped_;
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  bool stopped() {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::uint64_t> vertices_; // of each unit
  std::vector<bool> done_;
  std::vector<std::uint64_t> first_; // vertices before each unit, up to and including known_
  std::size_t known_ = 0;            // all units before it are done
  bool stopped_ = false;
};

} // namespace hyperiso
