// A cell that strokes run on: an arm over a box of sand, and a camera. Real and simulated alike.
#pragma once

#include <string>

#include "data/scan.h"
#include "robot_model/arm_record.h"
#include "robot_model/gated_motion.h"

namespace sandwright {

struct ExecuteOptions {
  double speed_share = 1;  // of all speeds, (0..1]
  // Execution::path_force_n of a lifted pass of the same stroke: the forces that belong to the
  // motion and not to the sand. Empty without one.
  std::vector<Eigen::Vector3d> in_air_n = {};
};

// What became of a motion. A fault of the arm is no exception: it ends the motion and is told.
struct Execution {
  bool finished = false;
  std::string end = {};     // "finished", or in a word what stopped it: "operator", "force", ...
  std::string reason = {};  // for people; empty where finished
  ArmRecord record = {};    // as far as it went
  // On the blade at each knot of a stroke's path, in W; empty where nothing measures it.
  std::vector<Eigen::Vector3d> path_force_n = {};
};

class Rig {
 public:
  virtual ~Rig() = default;
  virtual std::string name() const = 0;
  virtual bool measures_force() const { return false; }
  // Where the arm stands.
  virtual JointAngles Joints() = 0;
  // Moves the arm, or not at all where it does not stand at the motion's start.
  virtual Execution Execute(const GatedMotion& motion, const ExecuteOptions& options = {}) = 0;
  // What the camera sees from where the arm stands. Throws Error where there are no frames.
  virtual DepthView Look() = 0;
};

}  // namespace sandwright
