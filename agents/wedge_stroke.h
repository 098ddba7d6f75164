// A stroke that takes a wedge of sand along and drops it where it ends.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "data/base/config.h"
#include "env/agent.h"

namespace sandwright {

struct WedgeConfig {
  double start_back_m = 0;
  double end_back_m = 0.02;
  double depth_gain = 1.3;
  double most_depth_m = 0.02;
  double end_depth_m = -0.005;

  void Fields(FieldList& f) {
    f.Add("start_back_m", start_back_m, "start this far behind where the sand is taken [m]", -0.1,
          0.1);
    f.Add("end_back_m", end_back_m,
          "end this far before where the sand is to lie, as it lies ahead of the blade [m]", -0.1,
          0.1);
    f.Add("depth_gain", depth_gain,
          "depth at the start over that of a wedge of the volume to be moved", 0, 10);
    f.Add("most_depth_m", most_depth_m, "largest depth at the start [m]", 0, 0.03);
    f.Add("end_depth_m", end_depth_m, "depth at the end [m]", -0.005, 0.03);
  }
};

// Where the blade goes, in the plane of frame B.
struct WedgeLine {
  Eigen::Vector2d start_m, along;  // `along` has length 1
  double length_m = 0;
  Eigen::Vector2d end_m() const { return start_m + length_m * along; }
};

// The line that brings sand from one place to another (not the same), with the config's distances, a
// start inside the region and a length that an action can have.
WedgeLine WedgeLineOf(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                      const WedgeConfig& config, const Region& region);

// The action that takes `volume_m3` along the line: a wedge as wide as the blade whose depth falls
// evenly from the start to the end.
Action WedgeStroke(const TaskView& view, const WedgeLine& line, double volume_m3,
                   const WedgeConfig& config, const Blade& blade);

struct WedgeCandidate {
  WedgeLine line;
  double volume_m3 = 0;
};

// The actions of the candidates, the one that moves most first; without candidates, a short stroke
// that touches nothing.
std::vector<Action> MostFirst(const TaskView& view, std::vector<WedgeCandidate> candidates,
                              const WedgeConfig& config, const Blade& blade);

}  // namespace sandwright
