// Sand that differs from bed to bed: several models as one, for policies that must hold on all of them.
#pragma once

#include <memory>
#include <vector>

#include "env/heightfield.h"

namespace sandwright {

// Each bed keeps the model that its seed chose, all as likely; so a batch may hold beds of several.
class MixedSand final : public SandModel {
 public:
  // At least one. Error where blades or cell sizes differ.
  explicit MixedSand(std::vector<std::unique_ptr<SandModel>> models);

  std::string name() const override { return "mixed"; }
  const Blade& blade() const override { return models_.front()->blade(); }
  std::optional<double> cell_size_m() const override { return models_.front()->cell_size_m(); }
  SandState Start(HeightMap terrain, uint64_t seed) const override;
  int size() const { return static_cast<int>(models_.size()); }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override;

 private:
  std::vector<std::unique_ptr<SandModel>> models_;
};

// How far heightfields lie around a given one; each value is uniform within its spread.
struct RandomSandConfig {
  int64_t variants = 0;
  int64_t seed = 1;
  double repose_spread_deg = 3;
  double relaxation_spread = 0.5;
  double rupture_spread = 0.3;
  double bite_spread = 0.3;

  void Fields(FieldList& f) {
    f.Add("variants", variants,
          "heightfields around the configured one that beds are drawn from; 0: it alone", 0, 1000);
    f.Add("seed", seed, "of the variants", 0, 1e15);
    f.Add("repose_spread_deg", repose_spread_deg,
          "angle of repose, and of loose sand with it, up and down [deg]", 0, 20);
    f.Add("relaxation_spread", relaxation_spread, "relaxation_m, as a share of it", 0, 1);
    f.Add("rupture_spread", rupture_spread, "cut.rupture_ratio, as a share of it", 0, 1);
    f.Add("bite_spread", bite_spread, "cut.bite_m, as a share of it", 0, 1);
  }
};

// The heightfields of `spread` around `middle`. Error where an angle leaves its range.
MixedSand RandomSand(const HeightfieldConfig& middle, const RandomSandConfig& spread);

}  // namespace sandwright
