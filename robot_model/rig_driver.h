// Drives a rig between camera and sand; each motion from where the arm stands, through the gate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot_model/rig.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

struct Drive {
  std::vector<std::string> refused = {};  // by the gate: nothing moved
  std::optional<Execution> execution = {};  // none where refused
  double deviation_rad = 0;            // furthest of a measured joint from the motion's knots
  ToolPath path = {};                  // of the blade in the sand, of a stroke
  bool finished() const { return execution && execution->finished; }
  // In a line, where it did not finish.
  std::string why() const;
};

class RigDriver {
 public:
  // All must outlive the driver.
  RigDriver(Rig& rig, const SafetyGate& gate, const ScanConfig& scan)
      : rig_(rig), gate_(gate), scan_(scan) {}

  // To the (first) pose of the camera. Above a bed not yet seen the arm keeps clear of walls filled to the brim.
  // Where the blade stands lower than the retreat height nothing moves: that is for Lift().
  Drive ToCamera();
  // To each pose of the camera, and one scan of what is seen from them. An accepted map is what later
  // motions are gated on.
  struct Seen {
    Drive drive;      // the last one
    ScanResult scan;  // a bed that cannot be made out, or no frames: refused, with reasons
  };
  Seen Look();
  // A stroke, on the latest map.
  Drive Run(const Stroke& stroke, const ExecuteOptions& options = {});
  // The same, lifted until its lowest point is `clearance_m` above the highest sand.
  Drive RunLifted(const Stroke& stroke, double clearance_m, const ExecuteOptions& options = {});
  // Out of the sand, straight up.
  Drive Lift();

  // Before the first accepted scan: none.
  const std::optional<HeightMap>& latest() const { return latest_; }

 private:
  Drive ToPose(const JointAngles& to);
  Drive Execute(const Passage& passage, const ExecuteOptions& options);

  Rig& rig_;
  const SafetyGate& gate_;
  ScanConfig scan_;
  std::optional<HeightMap> latest_;
};

}  // namespace sandwright
