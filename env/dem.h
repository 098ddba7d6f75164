// Grains as a sand model: the slow truth that the fast models are measured against.
#pragma once

#include "data/base/error.h"
#include "env/dem_config.h"
#include "env/dem_run.h"
#include "env/sand_model.h"

namespace sandwright {

// A stroke that squeezed grains out of the box: its outcome is worth nothing.
class GrainsLost : public Error {
 public:
  using Error::Error;
};

// Runs every stroke through discrete elements (dem_run.h). Works at any cell size; the map of a
// state is the surface that a camera would see over its grains, rough as they are.
//
// Only grains within reach of the path are simulated; the others stay where they are, so the cost
// does not depend on the box. Each stroke starts from the grains that the one before left, without
// the history of their contacts, which moves a bed by less than it scatters (docs/sand.md).
class Dem final : public SandModel {
 public:
  explicit Dem(DemConfig config = {});

  std::string name() const override { return "dem"; }
  const Blade& blade() const override { return config_.blade; }
  const DemConfig& config() const { return config_; }

  // A bed of grains whose surface comes near to `terrain`; another seed, another packing.
  SandState Start(HeightMap terrain, uint64_t seed) const override;

  // One stroke with what the run found. A warning is logged where grains overlapped by more than 3 %.
  Outcome ApplyStroke(SandState& state, const ToolPath& path, DemReport& report) const;

 protected:
  // Throws Error where a state has no grains (it must come from Start), GrainsLost where some got lost.
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override;

 private:
  DemConfig config_;
};

}  // namespace sandwright
