// Steps a second of the shaping environment: random strokes on
// generated tasks of the 300 x 300 mm bed.
//
//   env_speed OUT.json
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "env/heightfield.h"
#include "env/shaping_env.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

struct Rate {
  double per_second;      // of the wall clock: suffers where other work shares the machine
  double per_cpu_second;  // of processor time over all threads: does not
  double rejected_share;
};

// Median of `repetitions` runs of `seconds` each.
Rate StepsPerSecond(ShapingEnv& env, int repetitions, double seconds) {
  RandomStream stream(1, StreamId("benchmark actions"));
  std::vector<float> actions(static_cast<size_t>(env.num_envs() * kActionSize));
  std::vector<double> rates, cpu_rates;
  double strokes = 0, rejected = 0;
  env.Reset(1);
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    double elapsed_s = 0;
    int64_t steps = 0;
    while (elapsed_s < seconds) {
      for (float& a : actions) a = static_cast<float>(stream.Uniform(-1, 1));
      for (const EpisodeSummary& summary : env.Step(actions).finished) {
        strokes += summary.metrics.at("strokes");
        rejected += summary.metrics.at("rejected_strokes");
      }
      steps += env.num_envs();
      elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    rates.push_back(static_cast<double>(steps) / elapsed_s);
    cpu_rates.push_back(static_cast<double>(steps) * CLOCKS_PER_SEC /
                        static_cast<double>(std::clock() - cpu_start));
  }
  std::ranges::sort(rates);
  std::ranges::sort(cpu_rates);
  return {rates[rates.size() / 2], cpu_rates[rates.size() / 2], rejected / strokes};
}

void Main(const char* file) {
  double load = 0;
  if (getloadavg(&load, 1) != 1) load = -1;
  nlohmann::json rows = nlohmann::json::array();
  const SafetyGate gate(LoadWorkcell(SANDWRIGHT_ROOT "/configs/workcell_small.yaml"));
  const auto measure = [&](const SandModel& sand, double cell_size_m, const SafetyGate* with,
                           int threads) {
    TaskConfig tasks;
    tasks.cell_size_m = cell_size_m;
    ShapingEnv env({}, {.sand = sand, .gate = with, .threads = threads}, TasksFrom(tasks));
    const Rate rate = StepsPerSecond(env, 5, 2);
    rows.push_back({{"suite", "env"},
                    {"name", sand.name() + (with ? " with gate" : "")},
                    {"threads", threads},
                    {"batch", env.num_envs()},
                    {"cell_size_m", cell_size_m},
                    {"per_second", rate.per_second},
                    {"per_cpu_second", rate.per_cpu_second},
                    {"rejected_share", rate.rejected_share}});
    fmt::print("{}\n", rows.back().dump());
  };
  for (int threads : {1, 2}) {
    HeightfieldConfig config;
    config.threads = threads;
    const Heightfield heightfield(config);
    for (double cell_size_m : {0.01, 0.005}) {
      measure(heightfield, cell_size_m, nullptr, threads);
      measure(heightfield, cell_size_m, &gate, threads);
    }
    measure(StillSand(), 0.01, nullptr, threads);
    measure(StillSand(), 0.01, &gate, threads);
  }
  const nlohmann::json result = {{"command", "env_speed docs/results/env.json"},
                                 {"what",
                                  "ShapingEnv::Step, random actions, 32 environments, budget 10, "
                                  "tasks generated at each reset; median of 5 runs of 2 s"},
                                 {"machine", MachineDescription()},
                                 {"load_average", load},  // much above 1: read per_cpu_second
                                 {"commit", BuildCommit()},
                                 {"rows", rows}};
  WriteFileAtomically(file, result.dump(2) + "\n");
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: env_speed OUT.json\n");
    return 2;
  }
  sandwright::Main(argv[1]);
  return 0;
}
