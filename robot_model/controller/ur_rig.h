// The real rig: a UR10 (CB3) behind its controller, and a camera that leaves frames.
#pragma once

#include <string>

#include "robot_model/controller/ur_controller.h"
#include "robot_model/rig.h"

namespace sandwright {

class UrRig final : public Rig {
 public:
  // Connects; Error (kRefused) where the cell is not calibrated (CalibrationFaults), and see
  // UrController for what else is refused. `gate` must outlive the rig; its workcell says
  // where the camera is.
  UrRig(const ControllerAddress& address, const SafetyGate& gate, bool armed);

  std::string name() const override;
  bool measures_force() const override { return true; }
  JointAngles Joints() override { return controller_.latest().actual_q; }
  // Sends one program and watches it; after any end but "finished" none is sent any more.
  Execution Execute(const GatedMotion& motion, const ExecuteOptions& options = {}) override;
  DepthView Look() override;

 private:
  const SafetyGate& gate_;
  UrController controller_;
  int programs_ = 0;
};

}  // namespace sandwright
