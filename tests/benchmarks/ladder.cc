// The ladder of reference tasks: each algorithm trained on each task with several seeds, beside the
// scores that others published.
//
//   ladder OUT.json SEEDS RUNG...      a rung is a file of configs/ladder without its ending
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "agents/train.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

constexpr int64_t kCurvePoints = 50;

// Deterministic policy, one training run each, +- over episodes: rl-baselines3-zoo, benchmark.md.
// CleanRL's are means of three seeds of training returns: docs/benchmark, tag pr-424.
struct Published {
  const char *rung, *source;
  double mean;
  std::optional<double> deviation;
  int64_t steps;
};
constexpr Published kPublished[] = {
    {"cart_pole_ppo", "rl-baselines3-zoo", 500.0, 0, 100000},
    {"half_cheetah_ppo", "CleanRL", 1442.64, 46.03, 1000000},
    {"half_cheetah_ppo", "rl-baselines3-zoo", 5819.099, 663.530, 1000000},
    {"hopper_ppo", "CleanRL", 2382.86, 271.74, 1000000},
    {"hopper_ppo", "rl-baselines3-zoo", 2410.435, 10.026, 1000000},
    {"acrobot_ppo", "rl-baselines3-zoo", -73.506, 18.2, 1000000},
    {"acrobot_ppo", "CleanRL", -86.36, 1.32, 500000},
    {"pendulum_sac", "rl-baselines3-zoo", -156.995, 88.714, 20000},
    {"pendulum_tqc", "rl-baselines3-zoo", -151.3, {}, 20000},
    {"mountain_car_sac", "rl-baselines3-zoo", 94.679, 1.134, 50000},
    {"half_cheetah_sac", "CleanRL", 9634.89, 1423.73, 1000000},
    {"hopper_sac", "CleanRL", 2310.46, 342.82, 1000000}};

void Summarise(nlohmann::json& row) {
  double sum = 0, squares = 0;
  for (const nlohmann::json& run : row.at("seeds")) {
    const double mean = run.at("mean_reward");
    sum += mean, squares += mean * mean;
  }
  const auto count = static_cast<double>(row["seeds"].size());
  row["mean_reward"] = sum / count;
  row["std_over_seeds"] = std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

// What episodes of training returned, by steps: kCurvePoints means over equal stretches, null where
// none ended.
nlohmann::json CurveOf(const std::filesystem::path& folder, int64_t total_steps) {
  std::istringstream csv(ReadFile(folder / "progress.csv"));
  std::array<double, kCurvePoints> sum{}, count{};
  std::string line;
  std::getline(csv, line);
  SAND_CHECK(line.starts_with("time/total_timesteps,rollout/ep_rew_mean,"), line);
  while (std::getline(csv, line)) {
    double step = 0, mean_return = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf", &step, &mean_return) < 2) continue;
    const auto stretch = std::min<int64_t>(
        kCurvePoints - 1, static_cast<int64_t>(step) * kCurvePoints / total_steps);
    sum[static_cast<size_t>(stretch)] += mean_return;
    ++count[static_cast<size_t>(stretch)];
  }
  nlohmann::json curve = nlohmann::json::array();
  for (size_t i = 0; i < sum.size(); ++i)
    curve.push_back(count[i] > 0 ? nlohmann::json(std::round(10 * sum[i] / count[i]) / 10)
                                 : nlohmann::json());
  return curve;
}

// `keep` gets the row after each seed: a run takes minutes to hours.
void Climb(const std::string& rung, int64_t seeds,
           const std::function<void(const nlohmann::json&)>& keep) {
  TrainConfig config;
  LoadYaml(FieldsOf(config), SANDWRIGHT_ROOT "/configs/ladder/" + rung + ".yaml");
  nlohmann::json row = {{"rung", rung},
                        {"reference", config.reference},
                        {"algorithm", config.algorithm},
                        {"steps", config.total_steps},
                        {"evaluation_episodes", config.evaluation_tasks},
                        {"command", fmt::format("ladder OUT.json {} {}", seeds, rung)},
                        {"machine", MachineDescription()},
                        {"commit", BuildCommit()}};
  for (const Published& p : kPublished) {
    if (rung != p.rung) continue;
    nlohmann::json published = {{"source", p.source}, {"mean", p.mean}, {"steps", p.steps}};
    if (p.deviation) published["std"] = *p.deviation;
    row["published"].push_back(published);
  }
  for (int64_t seed = 1; seed <= seeds; ++seed) {
    const auto folder = std::filesystem::temp_directory_path() / fmt::format("{}_{}", rung, seed);
    std::filesystem::remove_all(folder);
    const nlohmann::json run = Train(config, {folder, static_cast<uint64_t>(seed), 1, false});
    row["seeds"].push_back({{"seed", seed},
                            {"mean_reward", run.at("mean_reward")},
                            {"std_reward", run.at("std_reward")},
                            {"seconds", run.at("seconds")},
                            {"evaluation_seconds", run.at("evaluation_seconds")},
                            {"curve", CurveOf(folder, config.total_steps)}});
    fmt::print("{} seed {}: {:.1f} +- {:.1f} in {:.0f} s\n", rung, seed,
               run.at("mean_reward").get<double>(), run.at("std_reward").get<double>(),
               run.at("seconds").get<double>());
    std::fflush(stdout);
    Summarise(row);
    keep(row);
  }
}

// Rows of rungs that are climbed anew replace those in the file.
int Run(int argc, char** argv) {
  int64_t seeds = 0;
  if (argc >= 3) std::from_chars(argv[2], argv[2] + std::strlen(argv[2]), seeds);
  if (argc < 4 || seeds < 1) {
    fmt::print(stderr, "usage: ladder OUT.json SEEDS RUNG...\n");
    return 2;
  }
  InstallStopHandler();
  const std::filesystem::path out = argv[1];
  nlohmann::json result = {{"rows", nlohmann::json::array()}};
  if (std::filesystem::exists(out)) result = nlohmann::json::parse(ReadFile(out));
  for (int i = 3; i < argc; ++i) {
    Climb(argv[i], seeds, [&](const nlohmann::json& fresh) {
      auto& rows = result["rows"].get_ref<nlohmann::json::array_t&>();
      std::erase_if(rows, [&](const nlohmann::json& row) { return row.at("rung") == argv[i]; });
      rows.push_back(fresh);
      WriteFileAtomically(out, result.dump(1) + "\n");
    });
  }
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Run(argc, argv);
  } catch (const sandwright::Error& e) {
    fmt::print(stderr, "ladder: {}\n", e.what());
    return 1;
  }
}
