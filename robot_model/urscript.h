// A gated plan as a URScript program for PolyScope 3 (CB3), readable and small enough to be checked
// by a person: the controller interpolates the strokes itself.
#pragma once

#include <string>
#include <vector>

#include "data/stroke.h"
#include "robot_model/plan.h"

namespace sandwright {

// `verdict` must be an accepted one of these very strokes (SAND_CHECK). Lines and curves are
// movel and movep of the blade in the arm's base frame, turns are timed movel, transfers and
// the entry into each stroke's branch are movej to joint angles that the gate looked at. Blends
// take at most 0.4 of the shorter neighbouring segment, so two never overlap. The program
// starts with one popup and halts unless the arm stands at home. `name`: letter first, then
// letters, digits and _; at most 31 characters, else Error.
std::string MakeUrScript(const std::vector<Stroke>& strokes, const PlanVerdict& verdict,
                         const SafetyGate& gate, const std::string& name);

}  // namespace sandwright
