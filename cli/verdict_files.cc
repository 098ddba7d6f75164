#include "cli/verdict_files.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/picture.h"
#include "env/load_sand_model.h"

namespace sandwright {

std::vector<std::unique_ptr<SandModel>> LoadWorlds(const VerdictConfig& config, const SandModelConfig& sand) {
  std::vector<std::unique_ptr<SandModel>> worlds;
  for (const std::string& name : config.worlds) worlds.push_back(LoadSandModel(name, sand));
  return worlds;
}

std::string IsVerdictFile(const std::string& file) {
  return file.ends_with(".json") ? "" : file + ": a verdict is written as .json";
}

nlohmann::json WriteVerdict(const Verdict& verdict, const ShapingJob& job, const VerdictConfig& config,
                            const std::string& file) {
  if (verdict.stopped) ThrowIfStopRequested();
  nlohmann::json json = ToJson(verdict, job.goal, config);
  WriteFileAtomically(file, json.dump(2) + "\n");
  WritePicture(DrawVerdict(verdict, job.terrain, job.goal), std::filesystem::path(file).replace_extension(".png"));
  fmt::print("verdict: {}\n", VerdictInWords(json));
  return json;
}

nlohmann::json ReadVerdict(const std::string& file, const HeightMap& goal) {
  nlohmann::json verdict = nlohmann::json::parse(ReadFile(file), nullptr, false);
  try {
    CompareWithVerdict(verdict, goal, 0);
  } catch (const Error& e) {
    throw Error(file + ": " + e.what());
  }
  return verdict;
}

std::string VerdictInWords(const nlohmann::json& verdict) {
  std::string text = fmt::format("expected {:.2f} mm, in nine of ten {:.2f} to {:.2f} mm; {} strokes, {:.1f} minutes",
                                 verdict["expected_error_mm"].get<double>(), verdict["low90_mm"].get<double>(),
                                 verdict["high90_mm"].get<double>(), verdict["strokes"].get<int>(),
                                 verdict["arm_minutes"].get<double>());
  for (const auto& [reason, miss] : verdict["misses"].items()) {
    if (miss["share"] >= 0.005)
      text += fmt::format("\n  {:12} {:3.0f} % of the goal will be missed, {:.2f} mm of the error", reason,
                          100 * miss["share"].get<double>(), miss["of_error_mm"].get<double>());
  }
  return text;
}

std::string OutcomeInWords(const nlohmann::json& outcome) {
  return fmt::format("{:.2f} mm lies {} the {:.2f} to {:.2f} mm that were foreseen",
                     outcome["in_goal_mean_diff_mm"].get<double>(),
                     outcome["inside"].get<bool>() ? "inside" : "OUTSIDE",
                     outcome["low90_mm"].get<double>(), outcome["high90_mm"].get<double>());
}

}  // namespace sandwright
