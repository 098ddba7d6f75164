// Whether a cell's calibrations are there, good enough and still about this cell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot_model/workcell.h"

namespace sandwright {

// A real arm strikes its box where a cell is wrong by more than its margins: 5 mm to the walls.
inline constexpr double kMaxHeldOut_m = 0.002;

// Why strokes of this cell may not be sent to a real arm; empty where they may. Each of the four
// calibrations must be there, predict held-out measurements within kMaxHeldOut_m, be made with the
// kinematics that the cell has now, and neither its result nor what it was built upon may have
// changed since (a box touched with a tool that was measured anew is a box to touch anew).
// Simulated arms need none of this.
std::vector<std::string> CalibrationFaults(const Workcell& workcell);

// How well a calibration fits its measurements.
struct CalibrationError {
  int64_t poses = 0;
  double residual_m = 0, held_out_m = 0, held_out_rad = 0;
};

// A record of today about `values`, dotted keys of the cell (sections or numbers) as it is now.
CalibrationRecord MakeRecord(const Workcell& workcell, const CalibrationError& error,
                             std::vector<std::string> values);

// Writes the cell whole or not at all, with the comment lines that `like` (a workcell file) begins
// with. Throws Error, and writes nothing, where CheckWorkcell refuses the cell.
void SaveWorkcell(const Workcell& workcell, const std::filesystem::path& file,
                  const std::filesystem::path& like);

}  // namespace sandwright
