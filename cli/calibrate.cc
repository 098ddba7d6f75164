#include "cli/calibrate.h"

#include <spdlog/fmt/fmt.h>

#include <numbers>

namespace sandwright {

void CalibratedCell::Declare(CLI::App& app) {
  app.add_option("--workcell", workcell_file_, "the cell to calibrate (YAML)")->required();
  app.add_option("--out", out_file_, "write the calibrated cell here; default: over --workcell");
}

nlohmann::json CalibratedCell::Save(const Workcell& workcell, CalibrationRecord& record) const {
  const std::string file = out_file_.empty() ? workcell_file_ : out_file_;
  SaveWorkcell(workcell, file, workcell_file_);
  if (record.poses > 0)
    fmt::print("{} measurements: residual {:.2f} mm, held out {:.2f} mm, {:.3f} degrees\n",
               record.poses, 1e3 * record.residual_m, 1e3 * record.held_out_m,
               record.held_out_rad * 180 / std::numbers::pi);
  const std::vector<std::string> faults = CalibrationFaults(workcell);
  for (const std::string& fault : faults) fmt::print("  not ready for an arm: {}\n", fault);
  fmt::print("{}\n", file);
  nlohmann::json result = ToJson(FieldsOf(record));
  result["workcell_hash"] = WorkcellHash(workcell);
  result["faults"] = faults;
  return result;
}

std::vector<std::string> CameraKeys() {
  CameraModel camera;
  std::vector<std::string> keys;
  const FieldList fields = FieldsOf(camera);
  for (const Field& field : fields.fields()) keys.push_back("camera." + field.key);
  return keys;
}

nlohmann::json PoseJson(const PoseSetting& pose) {
  PoseSetting copy = pose;
  return ToJson(FieldsOf(copy));
}

}  // namespace sandwright
