// The fast physical sand model: a height map that avalanches at its angle of repose and a blade that
// cuts and pushes. Keeps volume; has no inertia and no grains.
#pragma once

#include "env/blade_cut.h"
#include "env/sand_model.h"

namespace sandwright {

struct HeightfieldConfig {
  double repose_deg = 33;
  double loose_deg = 28.5;
  double relaxation_m = 0.027;
  double substep_cells = 1;
  int64_t threads = 1;
  CutLaw cut;
  Blade blade;

  void Fields(FieldList& f) {
    f.Add("repose_deg", repose_deg, "angle of repose [deg]", 5, 60);
    f.Add(
        "loose_deg", loose_deg,
        "angle at which sand that moved in this stroke comes to rest, at most that of repose [deg]",
        5, 60);
    f.Add("relaxation_m", relaxation_m,
          "how far slopes even out while the blade moves: diffusion a metre of travel [m]", 0, 10);
    f.Add("substep_cells", substep_cells, "blade travel of one substep [cells]", 0.05, 1);
    f.Add("threads", threads, "threads for a batch of strokes", 1, 1024);
    f.Section("cut", cut);
    f.Section("blade", blade);
  }
};

// Works at any cell size. Deterministic: the same map and path give the same bytes.
class Heightfield final : public SandModel {
 public:
  // Throws Error where a value is out of its range, or loose_deg above repose_deg.
  explicit Heightfield(HeightfieldConfig config = {});

  std::string name() const override { return "heightfield"; }
  const Blade& blade() const override { return config_.blade; }
  const HeightfieldConfig& config() const { return config_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override;

 private:
  Outcome ApplyOne(SandState& state, const ToolPath& path) const;

  HeightfieldConfig config_;
};

}  // namespace sandwright
