// The controller without its network: modes, arm and programs, a control period at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/controller_fake/controller_fake_options.h"
#include "tests/support/controller_fake/script_runner.h"

namespace sandwright::fake {

struct TracePoint {
  double time_s = 0;
  JointAngles q;
  int segment = 0;  // output integer register 0
};

// How KEY messages deviate from a healthy controller's.
struct KeyFaults {
  bool swallow = false;
  double delay_s = 0;
};

class ControllerCore {
 public:
  explicit ControllerCore(const ControllerFakeOptions& options);

  ControllerState& state() { return state_; }
  const ControllerState& state() const { return state_; }
  FakeArm& arm() { return arm_; }
  // One control period of 8 ms.
  void Tick();
  // Packets for primary clients since the last call.
  std::vector<std::string> TakePackets();

  // A script as it came in; ends the running program.
  void Upload(const std::string& text);
  const std::vector<std::string>& scripts() const { return scripts_; }
  bool ProgramRunning() const { return runner_ != nullptr; }
  // Of the running program or the last one: joints each 8 ms.
  const std::vector<TracePoint>& trace() const { return trace_; }
  const std::vector<std::string>& messages() const { return messages_; }  // of textmsg
  const std::optional<ScriptFault>& last_fault() const { return last_fault_; }
  bool Load(const std::string& stored_program);
  const std::string& loaded() const { return loaded_; }

  // What an operator does at the pendant; false where it is not possible now.
  bool Play();
  bool Pause();
  bool StopProgram();
  bool PowerOn();
  void PowerOff();
  bool BrakeRelease();
  bool UnlockProtectiveStop();
  void AnswerPopup(bool go_on);
  void SetSlider(double fraction);
  void EmergencyStop(bool pressed);
  void SafeguardStop(bool active);
  // Stops the arm as for a collision; the program pauses.
  void ProtectiveStop(const std::string& why);
  void ForceSpike(double newton, double duration_s);
  void RejectScripts(bool reject) { reject_ = reject; }
  KeyFaults& key_faults() { return key_faults_; }
  // A popup on the pendant, as shown.
  const std::optional<Popup>& popup() const { return machine_.popup; }

 private:
  struct DuePacket {
    double at_s;
    std::string bytes;
  };

  void Begin(ScriptProgram program);
  void EndProgram();
  void Report(const ScriptFault& fault);
  void SendKey(const std::string& title, const std::string& text);
  void SetSafety(SafetyMode mode);
  void UpdateModes();
  void UpdateScale();
  void UpdateWatchdogs();
  void RunProgram();
  void UpdateState();

  ControllerFakeOptions options_;
  ControllerState state_;
  FakeArm arm_;
  ScriptMachine machine_;
  std::unique_ptr<ScriptRunner> runner_, secondary_;
  std::string loaded_;
  std::vector<std::string> scripts_, messages_;
  std::vector<TracePoint> trace_;
  std::optional<ScriptFault> last_fault_;
  std::vector<DuePacket> packets_;
  std::optional<double> next_mode_s_;  // when the next step towards wanted_mode_ comes
  RobotMode wanted_mode_;
  double scale_ = 0, spike_N_ = 0, spike_end_s_ = 0, popup_begin_s_ = 0;
  bool reject_ = false, safeguard_paused_ = false;
  KeyFaults key_faults_;
  std::string stopping_;  // program that has ended while the arm still slows down
};

}  // namespace sandwright::fake
