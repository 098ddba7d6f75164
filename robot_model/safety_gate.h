// The one gate in front of every arm: learned and hand-written strokes alike.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"
#include "robot_model/gated_motion.h"
#include "robot_model/reach_map.h"
#include "robot_model/stroke_motion.h"
#include "robot_model/workcell.h"

namespace sandwright {

enum class GateSampling {
  // Inside training: a few poses a stroke and wider margins; stops at the arm's first fault.
  kCoarse,
  kFine,  // before an arm: the whole motion at 125 Hz, every reason
};

struct GateVerdict {
  bool accepted = false;
  std::vector<std::string> reasons;   // empty where accepted; each with figure and limit
  double duration_s = 0;              // entry to exit, without the transfer
  double peak_joint_speed_share = 0;  // of the joints' rated speed, 0..1
  double min_clearance_m = 0;     // links to walls, table, sand and each other, as far as looked
  double min_singular_value = 0;  // of the flange Jacobian
  int branch = -1;                // -1: none reaches the stroke
  std::optional<StrokeMotion> motion;  // accepted, fine sampling only
};

// A joint move between strokes.
struct TransferVerdict {
  bool accepted = false;
  std::vector<std::string> reasons;
  std::vector<JointAngles> knots;  // accepted only: of StrokeMotion::kPeriod_s, both ends included
};

// Rejects a stroke whole, with its reasons; never changes one. What the coarse sampling accepts,
// the fine one accepts too. Immutable; any number of threads may Check() at once: distances are
// computed on one mjData a thread out of a pool (about 100 kB each, made on first use).
class SafetyGate {
 public:
  // Distances are measured up to this in the fine sampling, little
  // beyond the margin in the coarse one.
  static constexpr double kClearanceSeen_m = 0.2;

  explicit SafetyGate(const Workcell& workcell);
  ~SafetyGate();

  // `terrain`: the latest height map of the whole box (datum floor, else refused). Of the branches
  // that pass, the one nearest to `near` (the arm's joints before the stroke; default: home).
  GateVerdict Check(const Stroke& stroke, const HeightMap& terrain, GateSampling sampling,
                    const std::optional<JointAngles>& near = std::nullopt) const;

  // The straight joint move from `from` to `to` above the terrain, with the same limits.
  TransferVerdict CheckTransfer(const JointAngles& from, const JointAngles& to,
                                const HeightMap& terrain) const;

  // The ways to a motion that an arm may execute, from where it stands (robot_model/passage.cc);
  // all in the fine sampling, with the gate's limits from the first knot to the last.
  // A transfer to the stroke's entry, then the stroke.
  Passage PassStroke(const Stroke& stroke, const HeightMap& terrain, const JointAngles& from) const;
  Passage PassTransfer(const JointAngles& to, const HeightMap& terrain,
                       const JointAngles& from) const;
  // The same above a bed that nobody has looked at yet: sand up to the walls' rim.
  Passage PassUnseenTransfer(const JointAngles& to, const JointAngles& from) const;
  // The blade straight up, as it stands, to the retreat height, at kLiftSpeed_mps. The way out of
  // sand: how near the sand is does not count.
  Passage PassLift(const JointAngles& from) const;

  // Where strokes can start: measured when first asked for (a second or two for a large box), then kept.
  const ReachMap& reach() const;

  const Workcell& workcell() const;
  const BladeKinematics& kinematics() const;

 private:
  // Limits and distances of knots at 125 Hz above sand of that height.
  TransferVerdict CheckKnots(std::vector<JointAngles> knots, double sand_top_m) const;

  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace sandwright
