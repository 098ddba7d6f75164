// The gate of a workcell file, where there is an arm.
#pragma once

#include <memory>
#include <string>

#include "robot_model/safety_gate.h"

namespace sandwright {

// "": no arm, no gate. A file; a bare name that is no file here ("workcell_small.yaml") is one of
// the shipped configs. Throws Error as LoadWorkcell does.
std::unique_ptr<const SafetyGate> LoadGate(const std::string& workcell_file);

}  // namespace sandwright
