#include "robot_model/calibration/factory_kinematics.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// key = value of the section [mounting], comments behind # taken off.
std::map<std::string, std::string> ReadMounting(const std::filesystem::path& file) {
  std::istringstream lines(ReadFile(file));
  std::map<std::string, std::string> values;
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    line = Trimmed(line.substr(0, line.find('#')));
    const size_t equals = line.find('=');
    if (line.starts_with('['))
      section = line;
    else if (equals != std::string::npos && section == "[mounting]")
      values[Trimmed(line.substr(0, equals))] = Trimmed(line.substr(equals + 1));
  }
  return values;
}

// The files of a controller write a list as YAML does.
std::vector<double> SixNumbers(const std::map<std::string, std::string>& values,
                               const std::string& key, const std::filesystem::path& file) {
  const auto found = values.find(key);
  const std::string text = found == values.end() ? "missing" : found->second;
  std::vector<double> numbers;
  try {
    if (found != values.end()) numbers = YAML::Load(text).as<std::vector<double>>();
  } catch (const YAML::Exception&) {
    numbers.clear();
  }
  const bool finite = std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
  if (numbers.size() != 6 || !finite)
    throw Error(fmt::format("{}: [mounting] {}: {}; six numbers are needed", file.string(), key,
                            text));
  return numbers;
}

DhParameters ReadConf(const std::filesystem::path& file) {
  const auto values = ReadMounting(file);
  const auto status = values.find("calibration_status");
  if (status != values.end() && status->second != "2")
    throw Error(fmt::format(
        "{}: calibration_status = {}; needed: 2 (the joints' calibration is finished)",
        file.string(), status->second));
  DhParameters dh;
  const auto add = [&](const std::string& key, std::vector<double>& nominal) {
    const std::vector<double> delta = SixNumbers(values, key, file);
    for (size_t i = 0; i < 6; ++i) nominal[i] += delta[i];
  };
  add("delta_theta", dh.theta_rad);
  add("delta_a", dh.a_m);
  add("delta_d", dh.d_m);
  add("delta_alpha", dh.alpha_rad);
  return dh;
}

DhParameters ReadYaml(const std::filesystem::path& file) {
  DhParameters dh;
  LoadYaml(FieldsOf(dh), file);
  for (const auto& [key, list] : {std::pair{"a_m", &dh.a_m},
                                  {"d_m", &dh.d_m},
                                  {"alpha_rad", &dh.alpha_rad},
                                  {"theta_rad", &dh.theta_rad}})
    if (list->size() != 6)
      throw Error(
          fmt::format("{}: {} has {} numbers; 6 are needed", file.string(), key, list->size()));
  return dh;
}

}  // namespace

DhParameters ReadFactoryKinematics(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  const DhParameters dh =
      extension == ".yaml" || extension == ".yml" ? ReadYaml(file) : ReadConf(file);
  CheckFactoryKinematics(dh, file.string());
  return dh;
}

void CheckFactoryKinematics(const DhParameters& kinematics, const std::string& source) {
  const double shift_m = MeasureFlangeShift(DhParameters{}, kinematics).max_m;
  if (!(shift_m <= kMaxFactoryShift_m))
    throw Error(fmt::format("{}: the flange moves by up to {:.1f} mm from the nominal UR10; allowed: "
                            "{:.0f} mm. Is it another model?",
                            source, 1e3 * shift_m, 1e3 * kMaxFactoryShift_m));
}

FlangeShift MeasureFlangeShift(const DhParameters& from, const DhParameters& to, int poses,
                               uint64_t seed) {
  SAND_CHECK(poses > 0, poses);
  const Ur10 before(from), after(to);
  RandomStream stream(seed, StreamId("flange shift"));
  std::vector<double> shifts_m;
  for (int i = 0; i < poses; ++i) {
    JointAngles q;
    for (double& angle : q.rad) angle = stream.Uniform(-std::numbers::pi, std::numbers::pi);
    shifts_m.push_back(
        (before.Forward(q).translation() - after.Forward(q).translation()).norm());
  }
  std::ranges::sort(shifts_m);
  const auto quantile = [&](double share) {
    return shifts_m[static_cast<size_t>(share * static_cast<double>(shifts_m.size() - 1))];
  };
  return {quantile(0.5), quantile(0.95), shifts_m.back()};
}

}  // namespace sandwright
