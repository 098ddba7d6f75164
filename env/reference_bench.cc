#include "env/reference_bench.h"

#include <algorithm>

#include "data/base/random.h"
#include "data/base/stop.h"
#include "env/bench_clock.h"
#include "env/reference/mujoco_body.h"
#include "env/reference/reference_vec_env.h"

namespace sandwright {
namespace {

// What is left of the environment when the batch is taken away.
class Core {
 public:
  virtual ~Core() = default;
  // Row i goes on from what a fresh episode shows.
  virtual void Start(size_t i, std::span<const float> observation) = 0;
  virtual void Step(size_t i, std::span<const float> action) = 0;
};

// The tasks themselves, with episodes of their own.
class Tasks final : public Core {
 public:
  Tasks(const std::string& name, int count) {
    for (int i = 0; i < count; ++i) tasks_.push_back(MakeReferenceTask(name));
    seen_.resize(tasks_[0]->spec().observation.size());
  }
  void Start(size_t i, std::span<const float>) override { tasks_[i]->Reset(random_, seen_); }
  void Step(size_t i, std::span<const float> action) override { tasks_[i]->Step(action, seen_); }

 private:
  std::vector<std::unique_ptr<ReferenceTask>> tasks_;
  NumpyRandom random_{1};
  std::vector<float> seen_;
};

// mj_step and nothing else.
class RawMujoco final : public Core {
 public:
  RawMujoco(const mjModel& model, int frames, int count) : model_(model), frames_(frames) {
    for (int i = 0; i < count; ++i) data_.emplace_back(mj_makeData(&model));
  }
  void Start(size_t i, std::span<const float> observation) override {
    mjData* data = data_[i].get();
    mj_resetData(&model_, data);
    const auto joints = observation.begin() + model_.nq - 1;
    std::copy(observation.begin(), joints, data->qpos + 1);
    std::copy(joints, observation.end(), data->qvel);
    mj_forward(&model_, data);
  }
  void Step(size_t i, std::span<const float> action) override {
    std::ranges::copy(action, data_[i]->ctrl);
    for (int frame = 0; frame < frames_; ++frame) mj_step(&model_, data_[i].get());
  }

 private:
  const mjModel& model_;
  int frames_;
  std::vector<MujocoData> data_;
};

std::unique_ptr<Core> CoreOf(const std::string& name, int count) {
  if (name.starts_with("HalfCheetah"))
    return std::make_unique<RawMujoco>(HalfCheetahModel(), kHalfCheetahFrames, count);
  if (name.starts_with("Hopper"))
    return std::make_unique<RawMujoco>(HopperModel(), kHopperFrames, count);
  return std::make_unique<Tasks>(name, count);
}

nlohmann::json MeasureTask(const std::string& name, int batch, double seconds) {
  ReferenceVecEnv env(name, batch);
  const auto core = CoreOf(name, batch);
  const auto rows = static_cast<size_t>(batch), size = static_cast<size_t>(env.action_size()),
             seen = static_cast<size_t>(env.observation_spec().vec_size());
  const auto limit = static_cast<float>(env.spec().action_limit);
  RandomStream stream(1, StreamId("benchmark actions"));
  std::vector<float> actions(rows * size), scaled(rows * size);
  std::vector<double> env_us, core_us, shares;
  for (int run = 0; run < kBenchRuns; ++run) {
    const ObservationBatch start = env.Reset(1);
    for (size_t i = 0; i < rows; ++i) core->Start(i, std::span(start.vec).subspan(i * seen, seen));
    double env_s = 0, core_s = 0, steps = 0;
    for (; env_s + core_s < seconds; steps += batch) {
      ThrowIfStopRequested();
      for (size_t k = 0; k < actions.size(); ++k) {
        actions[k] = env.choices() > 0
                         ? static_cast<float>(stream.Index(static_cast<uint64_t>(env.choices())))
                         : static_cast<float>(stream.Uniform(-1, 1));
        scaled[k] = limit * actions[k];
      }
      const double start_s = Now_s();
      const StepBatch step = env.Step(actions);
      const double between_s = Now_s();
      for (size_t i = 0; i < rows; ++i) core->Step(i, std::span(scaled).subspan(i * size, size));
      for (size_t i = 0; i < rows; ++i) {
        if (step.terminated[i] || step.truncated[i])
          core->Start(i, std::span(step.observation.vec).subspan(i * seen, seen));
      }
      env_s += between_s - start_s;
      core_s += Now_s() - between_s;
    }
    env_us.push_back(1e6 * env_s / steps);
    core_us.push_back(1e6 * core_s / steps);
    shares.push_back(core_s / env_s);
  }
  return {{"name", name},
          {"batch", batch},
          {"step_us", Median(env_us)},
          {"core_us", Median(core_us)},
          {"core_share", Median(shares)}};
}

}  // namespace

void RunReferenceBench(double seconds, const std::function<void(const nlohmann::json&)>& done) {
  for (const std::string& name : ReferenceTaskNames()) {
    if (!name.ends_with("-v4")) done(MeasureTask(name, 64, seconds));  // the same work as v5
  }
}

}  // namespace sandwright
