// What the four calibrations share: the cell they read and write, and how they say what came out.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/calibration/marked_frames.h"

namespace sandwright {

class CalibratedCell {
 public:
  void Declare(CLI::App& app);
  Workcell Load() const { return LoadWorkcell(workcell_file_); }
  // Writes the cell (to --out, else in place) and prints the record and what is left to calibrate.
  // The keys of the result: the record's, `workcell_hash` and `faults`.
  nlohmann::json Save(const Workcell& workcell, CalibrationRecord& record) const;

 private:
  std::string workcell_file_, out_file_;
};

// Keys of a cell that whatever is measured through the camera builds upon.
std::vector<std::string> CameraKeys();
// {translation_m, rotation_vector_rad}.
nlohmann::json PoseJson(const PoseSetting& pose);

}  // namespace sandwright
