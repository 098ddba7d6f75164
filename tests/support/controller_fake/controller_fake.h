// A stand-in for a CB3 controller with an UR10: dashboard, primary, secondary, real-time and RTDE
// servers, an arm, and an interpreter that runs the scripts which clients upload.
//
// It knows nothing of the client that it tests: all bytes are packed here.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/controller_fake/controller_core.h"
#include "tests/support/controller_fake/controller_fake_options.h"

namespace sandwright {

// All methods may be called from any thread while the controller runs in its own.
class ControllerFake {
 public:
  // Listens and runs from here on; throws Error where a port cannot be had.
  explicit ControllerFake(const ControllerFakeOptions& options = {});
  ~ControllerFake();

  const ControllerPorts& ports() const;  // those it really has

  // What goes on.
  JointAngles joints() const;
  fake::ControllerState state() const;
  bool ProgramRunning() const;
  std::vector<std::string> scripts() const;          // all that were received, word for word
  std::vector<std::string> messages() const;         // of textmsg
  std::vector<fake::TracePoint> trace() const;       // of the program, each 8 ms
  std::optional<fake::ScriptFault> last_fault() const;  // of the last script
  uint64_t rtde_frames_sent() const;

  // The operator.
  void SetSlider(double fraction);
  void PausePendant();
  void ResumePendant();
  void StopPendant();
  void AnswerPopup(bool go_on);
  void StartForeignProgram(const std::string& name = "foreign");  // waits, moves nothing
  void SafeguardStop(bool active);
  void EmergencyStop(bool pressed = true);

  // Faults.
  void ProtectiveStop();
  void ForceSpike(double newton, double duration_s);
  void RejectScripts(bool reject = true);
  void SwallowKeyMessages(bool swallow = true);
  void DelayKeyMessages(double delay_s);
  void StallRtde(double duration_s);
  void CloseConnections(bool reset);  // all; FIN, or RST where `reset`
  void SplitBytes(bool split);        // one byte a packet, on all ports
  void CoalesceFrames(bool coalesce);  // several RTDE frames a packet
  void HideVariable(const std::string& name);  // NOT_FOUND to the next client that asks
  void OccupyInput(const std::string& name);   // IN_USE
  void SpeakOnlyProtocol1();
  // Puts the arm elsewhere (at rest only), as after jogging.
  void JogTo(const JointAngles& q);
  // Any other operator's or core's doing, in the controller's turn.
  void WithCore(const std::function<void(fake::ControllerCore&)>& act);

 private:
  class Servers;
  std::unique_ptr<Servers> servers_;
};

}  // namespace sandwright
