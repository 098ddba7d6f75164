// Policies on disk, the run folder, resuming: on a small bed with a small network.
#include "agents/train.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <functional>

#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "agents/run_folder.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "env/safetensors.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

std::filesystem::path Folder(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "train_test" / name;
  std::filesystem::remove_all(folder);
  return folder;
}

TrainConfig SmallConfig() {
  TrainConfig config;
  config.total_steps = 256;
  config.device = "cpu";
  config.task.cell_size_m = 0.02;
  config.task.max_strokes = 5;
  config.env.num_envs = 8;
  config.env.observation.rows = config.env.observation.columns = 12;
  config.network.channels = 4;
  config.network.hidden = 8;
  config.network.headings = 4;
  config.ppo.num_steps = config.expert.num_steps = 8;
  config.ppo.minibatch_size = config.expert.minibatch_size = 32;
  config.expert.evaluations = 8;
  config.expert.buffer_size = 160;  // fewer than the run's states
  config.group.num_steps = config.group.strokes = 8;
  config.group.minibatch_size = 32;
  config.evaluate_every = 128;
  config.evaluation_tasks = 2;
  config.checkpoint_every = 128;
  return config;
}

// For SAC and TQC, which log and check in stretches of 250 rounds.
TrainConfig ReplayingConfig() {
  TrainConfig config = SmallConfig();
  config.env.num_envs = 1;
  config.total_steps = 500;
  config.evaluate_every = config.checkpoint_every = 250;
  config.sac.batch_size = 8;
  config.sac.n_step = 3;
  config.sac.network = {.hidden = 8, .channels = 4, .features = 8};
  return config;
}

// What a policy is, without the run that it came from.
std::map<std::string, std::vector<float>> WeightsOf(const std::filesystem::path& file) {
  std::map<std::string, std::vector<float>> weights;
  for (const auto& [name, tensor] : ReadSafetensors(file).tensors) weights[name] = tensor.values;
  return weights;
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Train, LeavesTheWholeRunFolder) {
  const auto folder = Folder("whole");
  const auto result = Train(SmallConfig(), {folder, 3, 1, false});
  EXPECT_EQ(result["steps"], 256);
  EXPECT_GT(result["validation_in_goal_mean_diff_start_mm"], 0);
  for (const char* name : {"config.yaml", "best.safetensors", "agent.safetensors", "progress.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  EXPECT_EQ(LastCheckpoint(folder).filename(), "000000000256.safetensors");
  EXPECT_THAT(ReadFile(folder / "config.yaml"),
              HasSubstr("total_steps: 256  # strokes (steps of a reference task) to train on"));
  const std::string csv = ReadFile(folder / "progress.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 4);
  TrainConfig again;
  LoadYaml(FieldsOf(again), folder / "config.yaml");
  EXPECT_EQ(ToJson(FieldsOf(again)), [] {
    auto c = SmallConfig();
    return ToJson(FieldsOf(c));
  }());
}

TEST(Train, ResumedEqualsUninterruptedBitForBit) {
  for (const std::string algorithm : {"ppo", "expert_iteration", "group_gradient", "sac", "tqc"}) {
    const auto whole = Folder("uninterrupted"), parts = Folder("parts");
    const bool replays = algorithm == "sac" || algorithm == "tqc";
    TrainConfig config = replays ? ReplayingConfig() : SmallConfig();
    config.algorithm = algorithm;
    // linear would look ahead to total_steps
    config.ppo.learning_rate_schedule = config.expert.learning_rate_schedule =
        config.group.learning_rate_schedule = "constant";
    Train(config, {whole, 3, 1, false});
    TrainConfig half = config;
    half.total_steps /= 2;
    Train(half, {parts, 3, 1, false});
    EXPECT_NE(WeightsOf(parts / "agent.safetensors"), WeightsOf(whole / "agent.safetensors"));
    Train(config, {parts, 999, 2, true});  // the seed comes from the run; threads change nothing
    EXPECT_EQ(WeightsOf(parts / "agent.safetensors"), WeightsOf(whole / "agent.safetensors"));
    EXPECT_EQ(WeightsOf(LastCheckpoint(parts)), WeightsOf(LastCheckpoint(whole))) << algorithm;
    EXPECT_EQ(std::ranges::count(ReadFile(parts / "progress.csv"), '\n'), 1 + (replays ? 2 : 4));
  }
}

TEST(Train, APolicyOfSacActsAsAnAgent) {
  const auto folder = Folder("sac_agent");
  TrainConfig config = ReplayingConfig();
  config.algorithm = "sac";
  Train(config, {folder, 3, 1, false});
  const auto sand = LoadSandModel("heightfield", {});
  const auto file = (folder / "agent.safetensors").string();
  const auto agent = LoadAgent(file, {*sand});
  RandomStream stream(1);
  const std::vector<Task> tasks = {GenerateTask(config.task, stream)};
  const World world{*sand, nullptr, 1};
  const Evaluation once = Evaluate(*agent, world, config.env.episode, tasks, 5);
  EXPECT_EQ(once.Mean("in_goal_mean_diff_mm"),
            Evaluate(*LoadAgent(file, {*sand}), world, config.env.episode, tasks, 5).Mean("in_goal_mean_diff_mm"));
  EXPECT_EQ(agent->model_evaluations(), 0);
  config.initial_policy = file;
  EXPECT_THAT(MessageOf([&] { Train(config, {Folder("again"), 3, 1, false}); }),
              HasSubstr("algorithm = sac starts anew; allowed: empty"));
}

TEST(Train, StartsFromAPolicyThatIsThere) {
  const auto first = Folder("first"), second = Folder("second");
  TrainConfig config = SmallConfig();
  Train(config, {first, 3, 1, false});
  config.initial_policy = (first / "agent.safetensors").string();
  config.total_steps = 64;
  config.ppo.learning_rate = 0;
  const auto same = Train(config, {second, 4, 1, false});
  EXPECT_EQ(WeightsOf(second / "agent.safetensors"), WeightsOf(first / "agent.safetensors"));
  config.network.blocks = 2;  // which the file lacks: the identity until something is learnt
  const auto deeper = Train(config, {Folder("deeper"), 4, 1, false});
  EXPECT_EQ(deeper["validation_in_goal_mean_diff_mm"], same["validation_in_goal_mean_diff_mm"]);
  config.network.blocks = 0;
  config.network.hidden = 9;
  EXPECT_THAT(MessageOf([&] { Train(config, {Folder("third"), 4, 1, false}); }),
              HasSubstr("agent.safetensors"));
}

TrainConfig ReferenceConfig(const std::string& algorithm) {
  TrainConfig config;
  config.device = "cpu";
  config.algorithm = algorithm;
  config.reference = algorithm == "ppo" ? "CartPole-v1" : "Pendulum-v1";
  config.total_steps = 2000;
  config.evaluate_every = config.checkpoint_every = 1000;
  config.evaluation_tasks = 3;
  config.env.num_envs = 2;
  config.network.hidden = 8;
  config.network.normalize = true;
  config.ppo.num_steps = 50;
  config.ppo.learning_rate_schedule = "constant";
  config.sac.batch_size = 8;
  config.sac.network.hidden = 8;
  config.sac.noise_color = 1;
  return config;
}

TEST(Train, ReferenceTasksResumeBitForBit) {
  for (const std::string algorithm : {"ppo", "sac", "tqc"}) {
    const TrainConfig config = ReferenceConfig(algorithm);
    const auto whole = Folder("reference_whole"), parts = Folder("reference_parts");
    const nlohmann::json result = Train(config, {whole, 3, 1, false});
    EXPECT_EQ(result["steps"], 2000) << algorithm;
    EXPECT_EQ(result["mean_reward"].get<double>() < 0, algorithm != "ppo");
    EXPECT_GE(result["mean_reward_best"], result["mean_reward"]);
    for (const char* name : {"best.safetensors", "agent.safetensors", "progress.csv"})
      EXPECT_TRUE(std::filesystem::exists(whole / name)) << name;
    TrainConfig half = config;
    half.total_steps = 1000;
    Train(half, {parts, 3, 1, false});
    EXPECT_NE(WeightsOf(parts / "agent.safetensors"), WeightsOf(whole / "agent.safetensors"));
    Train(config, {parts, 999, 2, true});
    EXPECT_EQ(WeightsOf(parts / "agent.safetensors"), WeightsOf(whole / "agent.safetensors"));
    EXPECT_EQ(WeightsOf(LastCheckpoint(parts)), WeightsOf(LastCheckpoint(whole))) << algorithm;
  }
}

TEST(Train, WhatDoesNotFitIsNamed) {
  const auto folder = Folder("foreign");
  Train(ReferenceConfig("sac"), {folder, 3, 1, false});
  TrainConfig other = ReferenceConfig("tqc");
  EXPECT_THAT(MessageOf([&] { Train(other, {folder, 3, 1, true}); }),
              HasSubstr("algorithm is 'sac'; this run's is 'tqc'"));
}

TEST(Train, AStopLeavesACheckpoint) {
  const auto folder = Folder("stopped");
  EXPECT_EXIT(
      {
        InstallStopHandler();
        std::raise(SIGINT);
        try {
          Train(SmallConfig(), {folder, 3, 1, false});
        } catch (const Error& e) {
          std::exit(e.kind() == ErrorKind::kInterrupted &&
                            std::filesystem::exists(LastCheckpoint(folder))
                        ? 7
                        : 8);
        }
        std::exit(9);
      },
      ::testing::ExitedWithCode(7), "");
}

TEST(Train, NothingToResume) {
  EXPECT_THAT(MessageOf([] {
                Train(SmallConfig(), {Folder("none"), 3, 1, true});
              }),
              HasSubstr("no checkpoint to resume from"));
}

class SavedPolicy : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = Folder("policy") / "agent.safetensors";
    Train(SmallConfig(), {file_.parent_path(), 3, 1, false});
  }
  // The policy's file after `change`.
  static std::filesystem::path Changed(const std::function<void(Safetensors&)>& change) {
    Safetensors content = ReadSafetensors(file_);
    change(content);
    const auto changed = file_.parent_path() / "changed.safetensors";
    WriteSafetensors(content, changed);
    return changed;
  }
  static std::string LoadMessage(const std::filesystem::path& file) {
    return MessageOf([&] { LoadAgent(file.string(), {sand_, {}, 0.1, "cpu"}); });
  }
  static inline std::filesystem::path file_;
  static inline StillSand sand_{Blade{}};
};

TEST_F(SavedPolicy, ActsWithoutAnythingBesideIt) {
  const auto agent = LoadAgent(file_.string(), {sand_, {}, 0.1, "cpu"});
  ASSERT_TRUE(agent->region_size_m());
  EXPECT_DOUBLE_EQ((*agent->region_size_m())[0], 0.3);
  RandomStream stream(1, kEvaluationTasks);
  const TrainConfig config = SmallConfig();
  const Task task = GenerateTask(config.task, stream);
  const TaskView view{task.terrain, task.goal, RegionOf(task, {}), 0, 5, 0};
  const TaskView twice[] = {view, view};
  std::vector<RandomStream> streams(2, RandomStream(1));
  const auto actions = agent->Act(twice, streams);
  ASSERT_EQ(actions.size(), 2u);
  EXPECT_EQ(actions[0], actions[1]);
  for (float number : actions[0]) EXPECT_LT(std::abs(number), 1.0f);

  const TaskView elsewhere{task.terrain, task.goal, {0, 0, 0.2, 0.3}, 0, 5, 0};
  EXPECT_THAT(MessageOf([&] {
                agent->Act({&elsewhere, 1}, streams);
              }),
              HasSubstr("trained for a region of 0.3 x 0.3 m, the task's is 0.2 x 0.3 m"));
}

TEST_F(SavedPolicy, MismatchesAreNamed) {
  EXPECT_THAT(
      LoadMessage(Changed([](Safetensors& c) { c.metadata["schema"] = "sandwright-surrogate"; })),
      HasSubstr("not a policy: schema is 'sandwright-surrogate'"));
  EXPECT_THAT(LoadMessage(Changed([](Safetensors& c) { c.metadata["schema_version"] = "9"; })),
              HasSubstr("schema_version 9"));
  EXPECT_THAT(LoadMessage(Changed([](Safetensors& c) { c.metadata["action_spec"] = "[]"; })),
              HasSubstr("the policy's action is []"));
  EXPECT_THAT(LoadMessage(Changed([](Safetensors& c) { c.metadata["observation_spec"] = "{}"; })),
              HasSubstr("the policy's observation is {}"));
  EXPECT_THAT(LoadMessage(Changed([](Safetensors& c) { c.metadata["region_m"] = "nonsense"; })),
              HasSubstr("'region_m' is damaged"));
  EXPECT_THAT(
      LoadMessage(Changed([](Safetensors& c) { c.tensors.erase("network.value_head.bias"); })),
      HasSubstr("no tensor 'network.value_head.bias'"));
  EXPECT_THAT(LoadMessage(Changed([](Safetensors& c) {
                c.tensors["network.value_head.bias"] = {{2}, {0, 0}};
              })),
              HasSubstr("'value_head.bias' have shape [2], the network needs [1]"));
  EXPECT_THAT(LoadMessage(Changed(
                  [](Safetensors& c) { c.tensors["network.value_head.bias"].values[0] = NAN; })),
              HasSubstr("are not finite"));
}

TEST_F(SavedPolicy, CudaThatIsNotThereIsAnError) {
  EXPECT_THAT(MessageOf([] {
                LoadAgent(file_.string(), {sand_, {}, 0.1, "cuda"});
              }),
              ::testing::AnyOf(HasSubstr("no CUDA device works here"), HasSubstr("no error")));
}

}  // namespace
}  // namespace sandwright
