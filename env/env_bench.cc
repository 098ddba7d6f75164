#include "env/env_bench.h"

#include <malloc.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ctime>

#include "data/base/stop.h"
#include "env/bench_clock.h"
#include "env/load_gate.h"
#include "env/random_steps.h"
#include "env/shaping_env.h"

namespace sandwright {
namespace {

constexpr int kBatch = 32;
constexpr int kBatches[] = {1, 8, 128};  // of the small scene beside kBatch

// The same model, and how long its batches took.
class TimedSand final : public SandModel {
 public:
  explicit TimedSand(const SandModel& sand) : sand_(sand) {}
  std::string name() const override { return sand_.name(); }
  const Blade& blade() const override { return sand_.blade(); }
  std::optional<double> cell_size_m() const override { return sand_.cell_size_m(); }
  double seconds() const { return seconds_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override {
    const double start_s = Now_s();
    std::vector<Outcome> outcomes = sand_.Apply(states, paths);
    seconds_ += Now_s() - start_s;
    return outcomes;
  }

 private:
  const SandModel& sand_;
  mutable double seconds_ = 0;  // Step calls it from one thread
};

struct Scene {
  std::string name, workcell;
  TaskConfig task;
  EpisodeConfig episode;
};

std::vector<Scene> Scenes() {
  Scene small{"small", "workcell_small.yaml", {}, {}}, box{"box", "workcell.yaml", {}, {}};
  box.task.width_m = 1.2;
  box.task.depth_m = 0.8;
  box.task.goal_width_m = box.task.goal_depth_m = 0.3;
  box.episode.region_width_m = box.episode.region_depth_m = 0.3;
  return {small, box};
}

std::vector<float> RandomActions(int batch, RandomStream& stream) {
  std::vector<float> actions(static_cast<size_t>(batch * kActionSize));
  for (float& a : actions) a = static_cast<float>(stream.Uniform(-1, 1));
  return actions;
}

// Seconds of `work`, a mean over as many calls as fit into a fifth of a second.
double MeanSeconds(const std::function<void()>& work) {
  const double start_s = Now_s();
  int calls = 0;
  for (; Now_s() < start_s + 0.2; ++calls) work();
  return (Now_s() - start_s) / calls;
}

// A scene with its arm and a sand model.
struct Stage {
  Stage(const EnvBench& bench, const Scene& scene, const std::string& world, int threads)
      : sand(ModelOf(bench, world, threads)), gate(LoadGate(scene.workcell)), task(scene.task) {
    task.cell_size_m = sand->cell_size_m().value_or(task.cell_size_m);
    shaping.num_envs = kBatch;
    shaping.episode = scene.episode;
  }
  static std::unique_ptr<SandModel> ModelOf(const EnvBench& bench, const std::string& world,
                                            int threads) {
    SandModelConfig config = bench.sand;
    config.heightfield.threads = threads;
    return SandModelByName(world, config);
  }

  std::unique_ptr<SandModel> sand;
  std::unique_ptr<const SafetyGate> gate;
  TaskConfig task;
  ShapingConfig shaping;
};

// What this process has allocated and not given back [bytes].
double Allocated_bytes() {
  const auto heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd);
}

nlohmann::json MeasureMemory(const EnvBench& bench, const Scene& scene, const std::string& world) {
  constexpr int kRows = 512;
  Stage stage(bench, scene, world, 1);
  stage.shaping.num_envs = 1;
  const ShapingEnv one(stage.shaping, {*stage.sand, stage.gate.get()}, TasksFrom(stage.task));
  stage.shaping.num_envs = kRows;
  const double before = Allocated_bytes();
  const ShapingEnv many(stage.shaping, {*stage.sand, stage.gate.get()}, TasksFrom(stage.task));
  return {{"name", scene.name + ", " + world + ", memory"},
          {"environments", kRows},
          {"cell_size_m", stage.task.cell_size_m},
          {"kib_per_environment", (Allocated_bytes() - before) / 1024 / kRows}};
}

nlohmann::json StepAtRandom(const EnvBench& bench, const Scene& scene, const std::string& world) {
  Stage stage(bench, scene, world, bench.threads);
  stage.shaping.random_phase = false;
  stage.shaping.episode.sensor = {
      .noise_m = 0.0004, .registration_m = 0.002, .offset_m = 0.001, .hole_share = 0.01};
  stage.shaping.episode.tracking_error_m = 0.001;
  stage.shaping.observation.reach = true;
  ShapingEnv env(stage.shaping, {*stage.sand, stage.gate.get(), bench.threads},
                 TasksFrom(stage.task));
  nlohmann::json row = RunRandomSteps(env, bench.random_steps, 1).ToJson();
  row["name"] = scene.name + ", " + world + ", random steps";
  return row;
}

nlohmann::json MeasureScene(const EnvBench& bench, const Scene& scene, const std::string& world,
                            int threads, int batch) {
  Stage stage(bench, scene, world, threads);
  stage.shaping.num_envs = batch;
  const TimedSand sand(*stage.sand);
  const auto& gate = stage.gate;
  ShapingEnv env(stage.shaping, {sand, gate.get(), threads}, TasksFrom(stage.task));

  RandomStream stream(1, StreamId("benchmark actions"));
  std::vector<double> rates, cpu_rates;
  double steps = 0, spent_s = 0, strokes = 0, rejected = 0;
  for (int run = 0; run < kBenchRuns; ++run) {
    const double start_s = Now_s();
    const std::clock_t cpu_start = std::clock();
    double elapsed_s = 0, count = 0;
    while (elapsed_s < bench.seconds) {
      ThrowIfStopRequested();
      for (const EpisodeSummary& summary : env.Step(RandomActions(batch, stream)).finished) {
        strokes += summary.metrics.at("strokes");
        rejected += summary.metrics.at("rejected_strokes");
      }
      ++count;
      elapsed_s = Now_s() - start_s;
    }
    rates.push_back(count * batch / elapsed_s);
    cpu_rates.push_back(count * batch * CLOCKS_PER_SEC / static_cast<double>(std::clock() - cpu_start));
    steps += count;
    spent_s += elapsed_s;
  }
  // The gate and the observation apart, on the strokes of a step as it stands.
  const double step_s = spent_s / steps, sand_s = sand.seconds() / steps;
  const double observe_s = MeanSeconds([&] { env.Observe(); });
  const std::vector<float> actions = RandomActions(batch, stream);
  const double gate_s = MeanSeconds([&] {
    for (size_t i = 0; i < static_cast<size_t>(batch); ++i) {
      Action action;
      std::copy_n(actions.begin() + static_cast<std::ptrdiff_t>(i * kActionSize), kActionSize,
                  action.begin());
      const EpisodeState& episode = env.episodes()[i];
      gate->Check(DecodeAction(action, episode.sensed.map(), episode.region, sand.blade(), 0.1),
                  episode.sensed.map(), GateSampling::kCoarse);
    }
  });
  return {{"name", scene.name + ", " + world},
          {"threads", threads},
          {"batch", batch},
          {"cell_size_m", stage.task.cell_size_m},
          {"strokes_per_second", Median(rates)},
          {"strokes_per_cpu_second", Median(cpu_rates)},
          {"rejected_share", rejected / strokes},
          {"share_sand", sand_s / step_s},
          {"share_gate", gate_s / threads / step_s},
          {"share_observation", observe_s / step_s},
          {"gate_ms_per_stroke", 1e3 * gate_s / batch}};
}

}  // namespace

void RunEnvBench(const EnvBench& bench, const std::function<void(const nlohmann::json&)>& done) {
  for (const Scene& scene : Scenes()) {
    for (const std::string& world : bench.worlds) {
      for (int threads = 1; threads <= bench.threads; threads *= 2)
        done(MeasureScene(bench, scene, world, threads, kBatch));
    }
  }
  for (const std::string& world : bench.worlds) {
    for (const int batch : kBatches)
      done(MeasureScene(bench, Scenes().front(), world, bench.threads, batch));
  }
  for (const Scene& scene : Scenes()) {
    for (const std::string& world : bench.worlds) {
      done(MeasureMemory(bench, scene, world));
      if (bench.random_steps > 0) done(StepAtRandom(bench, scene, world));
    }
  }
}

}  // namespace sandwright
