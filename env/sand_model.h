// What sand does under the blade: one interface for the heightfield, the learned surrogate and the
// grains.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

struct GrainBed;

// The explicit state of one bed. Cheap to copy: what it holds is shared until one copy is changed, so
// a planner may hold thousands.
class SandState {
 public:
  explicit SandState(HeightMap map, std::shared_ptr<const GrainBed> grains = nullptr)
      : map_(std::make_shared<const HeightMap>(std::move(map))), grains_(std::move(grains)) {}
  const HeightMap& map() const { return *map_; }
  // What model `dem` keeps; null in a state of another model.
  const std::shared_ptr<const GrainBed>& grains() const { return grains_; }
  void Replace(HeightMap map, std::shared_ptr<const GrainBed> grains = nullptr) {
    map_ = std::make_shared<const HeightMap>(std::move(map));
    grains_ = std::move(grains);
  }
  // Which of the models of a MixedSand the bed belongs to.
  size_t variant() const { return variant_; }
  void set_variant(size_t variant) { variant_ = variant; }

 private:
  std::shared_ptr<const HeightMap> map_;
  std::shared_ptr<const GrainBed> grains_;
  size_t variant_ = 0;
};

// What one stroke did to one state.
struct Outcome {
  bool left_box = false;  // limited: part of the blade's path lay outside the walls and was clipped
  bool below_floor = false;    // limited: the path went below the floor and was raised to it
  CellRect changed;            // cells that may have changed (empty: none)
  double moved_volume_m3 = 0;  // sum of |change| / 2 over the changed cells
  // Of a learned model that knows it: how far the stroke lies from its training, above 1: beyond
  // (TrainingRange::Distance).
  std::optional<double> training_distance = {};
  bool limited() const { return left_box || below_floor; }
};

// Immutable: one model serves all threads.
class SandModel {
 public:
  virtual ~SandModel() = default;

  // "heightfield", "surrogate", ...
  virtual std::string name() const = 0;
  virtual const Blade& blade() const = 0;
  // The cell size the model is bound to [m]; none: works on any.
  virtual std::optional<double> cell_size_m() const { return std::nullopt; }

  // A bed for this model to work on. A model of grains fills a box whose surface comes near to
  // `terrain`, another packing for another seed; for others the terrain is the bed.
  virtual SandState Start(HeightMap terrain, uint64_t /*seed*/) const {
    return SandState(std::move(terrain));
  }

  // Applies paths[i] to states[i] in place, each independently of the others; the
  // same bytes for any thread count and batch order. Throws Error (NaN, wrong cell
  // size, empty path) before anything changes.
  std::vector<Outcome> Apply(std::span<SandState> states, std::span<const ToolPath> paths) const;
  // The same for strokes, sampled at half a cell.
  std::vector<Outcome> Apply(std::span<SandState> states, std::span<const Stroke> strokes) const;

 protected:
  virtual std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                            std::span<const ToolPath> paths) const = 0;
};

// "Nothing changes": the cheapest rival of every model.
class StillSand final : public SandModel {
 public:
  explicit StillSand(Blade blade = {}) : blade_(blade) {}
  std::string name() const override { return "none"; }
  const Blade& blade() const override { return blade_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath>) const override {
    return std::vector<Outcome>(states.size());
  }

 private:
  Blade blade_;
};

// moved volume between two maps of one grid, over `rect` [m^3].
double MovedVolume(const HeightMap& before, const HeightMap& after, const CellRect& rect);

}  // namespace sandwright
