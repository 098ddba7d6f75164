// What a workcell file remembers of how its poses were measured.
#pragma once

#include <string>
#include <vector>

#include "data/base/config.h"

namespace sandwright {

// One calibration of a cell. An empty date: never made.
struct CalibrationRecord {
  std::string date;         // UTC, ISO 8601
  int64_t poses = 0;        // measurements that went in
  double residual_m = 0;    // root mean square over them
  double held_out_m = 0;    // the same over each as the others predict it
  double held_out_rad = 0;  // of orientation; 0 where only positions are measured
  std::string kinematics_hash;      // CalibrationHash of the cell it was made with
  std::vector<std::string> values;  // keys of the cell that it set or built upon
  std::string values_hash;          // over what these held

  void Fields(FieldList& f) {
    f.Add("date", date, "UTC; empty: never calibrated");
    f.Add("poses", poses, "measurements used", 0, 1e6);
    f.Add("residual_m", residual_m, "rms over them [m]", 0, 10);
    f.Add("held_out_m", held_out_m, "rms over each as the others predict it [m]", 0, 10);
    f.Add("held_out_rad", held_out_rad, "the same of orientation [rad]", 0, 6.3);
    f.Add("kinematics_hash", kinematics_hash, "of the kinematics it was made with");
    f.Add("values", values, "keys that it set or built upon");
    f.Add("values_hash", values_hash, "of what they held");
  }
};

// The four that a real arm needs, in the order in which they are made: each builds on those before.
struct CalibrationRecords {
  CalibrationRecord kinematics, hand_eye, tool, box;

  void Fields(FieldList& f) {
    f.Section("kinematics", kinematics);
    f.Section("hand_eye", hand_eye);
    f.Section("tool", tool);
    f.Section("box", box);
  }
};

}  // namespace sandwright
