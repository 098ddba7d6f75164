#include "robot_model/controller/ur_rig.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"
#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/camera_pose.h"

namespace sandwright {
namespace {

ArmRecord RecordOf(const std::vector<RunSample>& samples) {
  ArmRecord record;
  for (const RunSample& sample : samples) {
    record.time_s.push_back(sample.time_s);
    record.commanded.push_back(sample.state.target_q);
    record.measured.push_back(sample.state.actual_q);
    record.speed_radps.push_back(sample.state.actual_qd_radps);
    record.force_n.push_back(sample.state.tcp_force.head<3>());
  }
  return record;
}

ForceBaseline PathForces(const GatedMotion& motion, const std::vector<RunSample>& samples) {
  if (motion.kind() != GatedMotion::Kind::kStroke) return {};
  std::vector<ForceSample> forces;
  for (const RunSample& sample : samples)
    forces.push_back({sample.knot, sample.state.tcp_force.head<3>()});
  return MakeForceBaseline(forces, motion.stroke_begin() + motion.stroke_motion().path_begin,
                           motion.stroke_begin() + motion.stroke_motion().path_end);
}

const Workcell& Calibrated(const Workcell& cell) {
  std::vector<std::string> faults = CalibrationFaults(cell);
  if (!faults.empty()) throw Error("workcell " + cell.name, std::move(faults));
  return cell;
}

}  // namespace

UrRig::UrRig(const ControllerAddress& address, const SafetyGate& gate, bool armed)
    : gate_(gate), controller_(address, Calibrated(gate.workcell()), armed) {}

std::string UrRig::name() const {
  return controller_.identity().model + " " + controller_.identity().serial_number;
}

Execution UrRig::Execute(const GatedMotion& motion, const ExecuteOptions& options) {
  const ArmProgram program = MakeArmProgram(motion, gate_, fmt::format("sandwright_{}", programs_++),
                                            options.speed_share);
  const RunOutcome outcome = controller_.Run(program, {}, options.in_air_n);
  return {.finished = outcome.end == RunEnd::kFinished,
          .end = Name(outcome.end),
          .reason = outcome.reason,
          .record = RecordOf(outcome.samples),
          .path_force_n = PathForces(motion, outcome.samples)};
}

DepthView UrRig::Look() {
  const Workcell& cell = gate_.workcell();
  return {TakeFrames(cell.camera.source), CameraInBox(cell, Joints())};
}

}  // namespace sandwright
