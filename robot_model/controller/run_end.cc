#include "robot_model/controller/run_end.h"

namespace sandwright {

const char* Name(RunEnd end) {
  switch (end) {
    case RunEnd::kFinished: return "finished";
    case RunEnd::kRefused: return "refused";
    case RunEnd::kStoppedByOperator: return "stopped_by_operator";
    case RunEnd::kForce: return "force";
    case RunEnd::kProtectiveStop: return "protective_stop";
    case RunEnd::kSafeguardStop: return "safeguard_stop";
    case RunEnd::kEmergencyStop: return "emergency_stop";
    case RunEnd::kSafetyFault: return "safety_fault";
    case RunEnd::kLinkLost: return "link_lost";
    case RunEnd::kScriptError: return "script_error";
    case RunEnd::kControllerError: return "controller_error";
    case RunEnd::kForeignProgram: return "foreign_program";
    case RunEnd::kLeftPlan: return "left_plan";
    case RunEnd::kDidNotStart: return "did_not_start";
    case RunEnd::kTookTooLong: return "took_too_long";
    case RunEnd::kNotAtStart: return "not_at_start";
    case RunEnd::kOtherTcp: return "other_tcp";
    case RunEnd::kOtherPayload: return "other_payload";
    case RunEnd::kBeatLost: return "beat_lost";
    case RunEnd::kProgramEnded: return "program_ended";
    case RunEnd::kInternalFault: return "internal_fault";
  }
  return "unknown";
}

}  // namespace sandwright
