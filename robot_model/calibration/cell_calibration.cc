#include "robot_model/calibration/cell_calibration.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

std::string ValuesHash(Workcell cell, const std::vector<std::string>& keys) {
  const nlohmann::json all = ToJson(FieldsOf(cell));
  std::string text;
  for (const std::string& key : keys) {
    std::string path = "/" + key;
    std::ranges::replace(path, '.', '/');
    const nlohmann::json::json_pointer pointer(path);
    text += key + (all.contains(pointer) ? all[pointer].dump() : " is no key") + "\n";
  }
  return Sha256Hex(text);
}

void AddFaults(const Workcell& cell, const CalibrationRecord& record, const std::string& name,
               std::vector<std::string>& faults) {
  const std::string again = fmt::format("make it: sandwright calibrate {}", name);
  if (record.date.empty()) {
    faults.push_back(fmt::format("{}: never calibrated; {}", name, again));
    return;
  }
  if (record.held_out_m > kMaxHeldOut_m)
    faults.push_back(fmt::format("{}: held-out error {:.2f} mm; allowed: {:.2f} mm", name,
                                 1e3 * record.held_out_m, 1e3 * kMaxHeldOut_m));
  if (record.kinematics_hash != CalibrationHash(cell))
    faults.push_back(fmt::format("{}: made with other kinematics ({:.12}...) than the cell has ({:.12}"
                                 "...); {}",
                                 name, record.kinematics_hash, CalibrationHash(cell), again));
  else if (record.values.empty() || record.values_hash != ValuesHash(cell, record.values))
    faults.push_back(fmt::format("{}: its result or what it was built upon ({}) changed since {}; {}",
                                 name, fmt::join(record.values, ", "), record.date, again));
}

}  // namespace

std::vector<std::string> CalibrationFaults(const Workcell& workcell) {
  const CalibrationRecords& made = workcell.calibration;
  std::vector<std::string> faults;
  AddFaults(workcell, made.kinematics, "kinematics", faults);
  AddFaults(workcell, made.hand_eye, "hand-eye", faults);
  AddFaults(workcell, made.tool, "tool", faults);
  AddFaults(workcell, made.box, "box", faults);
  return faults;
}

CalibrationRecord MakeRecord(const Workcell& workcell, const CalibrationError& error,
                             std::vector<std::string> values) {
  CalibrationRecord record;
  record.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  record.poses = error.poses;
  record.residual_m = error.residual_m;
  record.held_out_m = error.held_out_m;
  record.held_out_rad = error.held_out_rad;
  record.kinematics_hash = CalibrationHash(workcell);
  record.values_hash = ValuesHash(workcell, values);
  record.values = std::move(values);
  return record;
}

void SaveWorkcell(const Workcell& workcell, const std::filesystem::path& file,
                  const std::filesystem::path& like) {
  CheckWorkcell(workcell, file.string());
  std::istringstream lines(ReadFile(like));
  std::string text;
  for (std::string line; std::getline(lines, line) && line.starts_with('#');) text += line + "\n";
  Workcell cell = workcell;
  WriteFileAtomically(file, text + ToYaml(FieldsOf(cell)));
}

}  // namespace sandwright
