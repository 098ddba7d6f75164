#include "robot_model/plan.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

// Shortest decimal that reads back to the same number.
std::string StrokesText(const std::vector<Stroke>& strokes) {
  std::string text;
  for (const Stroke& stroke : strokes) {
    text += "  - control_points_m: [";
    for (size_t i = 0; i < stroke.control_points_m.size(); ++i) {
      const Eigen::Vector3d& p = stroke.control_points_m[i];
      text += fmt::format("{}[{}, {}, {}]", i ? ", " : "", p.x(), p.y(), p.z());
    }
    text += fmt::format("]\n    degree: {}\n    speed_mps: {}\n", stroke.degree, stroke.speed_mps);
  }
  return text;
}

std::string SealOver(const std::vector<Stroke>& strokes, const PlanSeal& seal) {
  return Sha256Hex(StrokesText(strokes) + seal.blade + seal.workcell + seal.calibration +
                   seal.terrain);
}

}  // namespace

std::string TerrainHash(const HeightMap& terrain) {
  std::string bytes =
      fmt::format("{} {} {} {} ", terrain.rows, terrain.columns, terrain.cell_size_m,
                  terrain.datum == Datum::kFloor ? "floor" : "relative");
  bytes.append(reinterpret_cast<const char*>(terrain.height_m.data()),
               terrain.height_m.size() * sizeof(float));
  return Sha256Hex(bytes);
}

PlanSeal MakeSeal(const std::vector<Stroke>& strokes, const Workcell& workcell,
                  const HeightMap& terrain) {
  PlanSeal seal{BladeHash(workcell), WorkcellHash(workcell), CalibrationHash(workcell),
                TerrainHash(terrain), ""};
  seal.seal = SealOver(strokes, seal);
  return seal;
}

Plan ReadPlan(const std::filesystem::path& file) {
  Plan plan{ReadStrokes(file), std::nullopt};
  const YAML::Node root = YAML::LoadFile(file.string());
  if (!root["seal"]) return plan;
  PlanSeal seal;
  for (const auto& [key, value] :
       {std::pair{"blade_hash", &seal.blade}, std::pair{"workcell_hash", &seal.workcell},
        std::pair{"calibration_hash", &seal.calibration}, std::pair{"terrain_hash", &seal.terrain},
        std::pair{"seal", &seal.seal}}) {
    if (!root[key] || !root[key].IsScalar())
      throw Error(fmt::format("{}: the plan is sealed but has no {}", file.string(), key));
    *value = root[key].Scalar();
  }
  plan.seal = seal;
  return plan;
}

void WritePlan(const Plan& plan, const std::filesystem::path& file) {
  std::string text = "schema: sandwright-plan\nschema_version: 1\nframe: box\n";
  if (plan.seal) {
    text += "# Written by `sandwright check --seal`; after an edit the plan must be sealed anew.\n";
    text += fmt::format(
        "blade_hash: {}\nworkcell_hash: {}\ncalibration_hash: {}\nterrain_hash: {}\nseal: {}\n",
        plan.seal->blade, plan.seal->workcell, plan.seal->calibration, plan.seal->terrain,
        plan.seal->seal);
  }
  text += plan.strokes.empty() ? "strokes: []\n" : "strokes:\n" + StrokesText(plan.strokes);
  WriteFileAtomically(file, text);
}

void CheckSeal(const Plan& plan, const Workcell& workcell, const HeightMap& terrain,
               const std::string& source) {
  if (!plan.seal)
    throw Error(source, {"the plan is not sealed; look at it and run `sandwright check --seal`"});
  const PlanSeal& seal = *plan.seal;
  std::vector<std::string> reasons;
  const auto compare = [&](const char* what, const std::string& of_plan, const std::string& now) {
    if (of_plan != now)
      reasons.push_back(fmt::format("made for another {}: {}..., now {}...", what,
                                    of_plan.substr(0, 12), now.substr(0, 12)));
  };
  compare("blade", seal.blade, BladeHash(workcell));
  compare("workcell", seal.workcell, WorkcellHash(workcell));
  compare("calibration of the arm", seal.calibration, CalibrationHash(workcell));
  compare("scan", seal.terrain, TerrainHash(terrain));
  if (SealOver(plan.strokes, seal) != seal.seal)
    reasons.push_back("edited since it was sealed; look at it and run `sandwright check --seal`");
  if (!reasons.empty()) throw Error(source, reasons);
}

Plan ReadSealedPlan(const std::filesystem::path& file, const Workcell& workcell,
                    const HeightMap& terrain) {
  Plan plan = ReadPlan(file);
  CheckSeal(plan, workcell, terrain, file.string());
  return plan;
}

PlanVerdict CheckPlan(const SafetyGate& gate, const std::vector<Stroke>& strokes,
                      const HeightMap& terrain) {
  PlanVerdict verdict;
  JointAngles at = gate.workcell().home();
  const auto transfer = [&](const JointAngles& to, const std::string& name) {
    verdict.transfers.push_back(gate.CheckTransfer(at, to, terrain));
    for (const std::string& reason : verdict.transfers.back().reasons)
      verdict.reasons.push_back(name + ": " + reason);
  };
  for (size_t i = 0; i < strokes.size(); ++i) {
    const GateVerdict& stroke =
        verdict.strokes.emplace_back(gate.Check(strokes[i], terrain, GateSampling::kFine, at));
    for (const std::string& reason : stroke.reasons)
      verdict.reasons.push_back(fmt::format("stroke {}: {}", i, reason));
    if (!stroke.motion) continue;
    transfer(stroke.motion->knots.front(), fmt::format("transfer to stroke {}", i));
    at = stroke.motion->knots.back();
  }
  transfer(gate.workcell().home(), "transfer home");
  verdict.accepted = verdict.reasons.empty();
  return verdict;
}

nlohmann::json ToJson(const PlanVerdict& verdict, const Workcell& workcell) {
  nlohmann::json strokes = nlohmann::json::array();
  for (const GateVerdict& stroke : verdict.strokes)
    strokes.push_back({{"accepted", stroke.accepted},
                       {"reasons", stroke.reasons},
                       {"duration_s", stroke.duration_s},
                       {"peak_joint_speed_share", stroke.peak_joint_speed_share},
                       {"min_clearance_m", stroke.min_clearance_m},
                       {"min_singular_value", stroke.min_singular_value},
                       {"branch", stroke.branch}});
  return {{"accepted", verdict.accepted},
          {"reasons", verdict.reasons},
          {"strokes", strokes},
          {"calibration_hash", CalibrationHash(workcell)}};
}

}  // namespace sandwright
