// The one gate in front of every arm: learned and hand-written strokes alike.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"
#include "robot_model/stroke_motion.h"
#include "robot_model/workcell.h"

namespace sandwright {

enum class GateSampling {
  kCoarse,  // inside training: a few poses a stroke and wider margins; stops at the first fault of the arm
  kFine,    // before an arm: the whole motion at 125 Hz, every reason
};

struct GateVerdict {
  bool accepted = false;
  std::vector<std::string> reasons;  // empty where accepted; each with figure and limit
  double duration_s = 0;             // entry to exit, without the transfer
  double peak_joint_speed_share = 0; // of the joints' rated speed, 0..1
  double min_clearance_m = 0;        // links to walls, table and each other; at most kClearanceSeen_m
  double min_singular_value = 0;
  int branch = -1;                   // -1: none reaches the stroke
  std::optional<StrokeMotion> motion;  // accepted, fine sampling only
};

// Rejects a stroke whole, with its reasons; never changes one. What the coarse sampling accepts, the
// fine one accepts too. Immutable; any number of threads may Check() at once: collision queries work
// on one mjData a thread at a time out of a pool (about 50 kB each, made on first use).
class SafetyGate {
 public:
  static constexpr double kClearanceSeen_m = 0.2;

  explicit SafetyGate(const Workcell& workcell);
  ~SafetyGate();

  // `terrain`: the latest height map of the whole box (datum floor, else refused).
  GateVerdict Check(const Stroke& stroke, const HeightMap& terrain, GateSampling sampling) const;

  const Workcell& workcell() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace sandwright
