// The gate between two strokes: is the new scan to be believed, and did the sand do what was foreseen?
#pragma once

#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/scan.h"
#include "data/stroke.h"

namespace sandwright {

struct RescanLimits {
  double max_invalid_share = 0.3;
  double max_registration_m = 0.003;
  double swath_margin_m = 0.10;
  double max_outside_rms_m = 0.003;
  double floor_tolerance_m = 0.004;
  double max_prediction_rmse_m = 0.010;
  double max_net_share = 1.0;

  void Fields(FieldList& f) {
    f.Add("max_invalid_share", max_invalid_share, "pixels of the box without a reading [-]", 0, 1);
    f.Add("max_registration_m", max_registration_m,
          "furthest that a wall's corner may lie from where the arm's kinematics put it [m]", 0.0001, 0.1);
    f.Add("swath_margin_m", swath_margin_m, "around the path: where sand may move [m]", 0.02, 1);
    f.Add("max_outside_rms_m", max_outside_rms_m,
          "root mean square change of the sand beyond that: something else was moved [m]", 0.0001, 0.1);
    f.Add("floor_tolerance_m", floor_tolerance_m, "sand seen so far below the floor is no sand [m]", 0, 0.1);
    f.Add("max_prediction_rmse_m", max_prediction_rmse_m,
          "of measured against predicted heights where sand may move; above it the plan no longer holds [m]",
          0.0001, 0.5);
    f.Add("max_net_share", max_net_share,
          "net change of volume there, of what was moved: sand that came or went [-]", 0, 10);
  }
};

enum class RescanVerdict {
  kAccept,
  kReplan,  // a good scan of sand that did something else: strokes foreseen for it are void
  kStop,    // not to be believed, or something is wrong in the cell
};

struct RescanFigures {
  RescanVerdict verdict = RescanVerdict::kAccept;
  std::vector<std::string> reasons;  // against kAccept; each with figure and limit
  double invalid_share = 0, registration_m = 0;
  double outside_rms_m = 0;     // change beyond the swath
  double lowest_m = 0;          // height
  double prediction_rmse_m = 0, change_rms_m = 0;  // in the swath
  double moved_m3 = 0, predicted_moved_m3 = 0;     // half of the sum of |change| in the swath
  double net_m3 = 0;
};

// All maps on one grid. `predicted` is the model's answer to the stroke's path from `before`.
RescanFigures CheckRescan(const HeightMap& before, const HeightMap& predicted,
                          const ScanResult& after, const ToolPath& path, const RescanLimits& limits);

// "accept", "replan", "stop".
const char* NameOf(RescanVerdict verdict);
nlohmann::json ToJson(const RescanFigures& figures);

}  // namespace sandwright
