// How a run of one program ended.
#pragma once

#include <string>

namespace sandwright {

enum class RunEnd {
  kFinished,           // the controller, the program and the arm's state agree
  kRefused,            // not sent: an earlier fault, or the arm is not as it must be
  kStoppedByOperator,  // Ctrl-C or Stop()
  kForce,              // contact
  kProtectiveStop,
  kSafeguardStop,
  kEmergencyStop,
  kSafetyFault,       // violation, fault, recovery, or the arm is no longer RUNNING
  kLinkLost,          // no news for 100 ms, or a connection ended
  kScriptError,       // with line and column
  kControllerError,   // an error of level violation or fault
  kForeignProgram,    // another program took over
  kLeftPlan,          // joints away from the planned ones
  kDidNotStart,
  kTookTooLong,
  kNotAtStart,
  kOtherTcp,
  kOtherPayload,
  kBeatLost,       // the program heard nothing from the PC
  kProgramEnded,   // before its end, or without agreement about it
  kInternalFault,  // of this program, while it watched
};

const char* Name(RunEnd end);  // "protective_stop"

struct RunVerdict {
  RunEnd end = RunEnd::kFinished;
  std::string reason;
};

}  // namespace sandwright
