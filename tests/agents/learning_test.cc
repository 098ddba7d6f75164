// Learning, shown: the shipped small configuration, trained here and now,
// against its rivals on tasks that no training saw.
#include <gtest/gtest.h>

#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "env/load_gate.h"
#include "agents/train.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

TEST(Learning, AMinuteOfPpoBeatsRandomOnUnseenTasks) {
  TrainConfig config;
  LoadYaml(FieldsOf(config), SANDWRIGHT_ROOT "/configs/train_ppo_small.yaml");
  config.device = "cpu";
  config.workcell = SANDWRIGHT_ROOT "/configs/" + config.workcell;
  config.evaluate_every = config.checkpoint_every = 0;
  const auto folder = std::filesystem::path(::testing::TempDir()) / "learning_test";
  std::filesystem::remove_all(folder);
  Train(config, {folder, 1, 2, false});

  const auto sand = LoadSandModel(config.model, config.sand);
  const auto gate = LoadGate(config.workcell);
  const World world{*sand, gate.get(), 2};
  std::vector<Task> tasks;
  for (uint64_t i = 0; i < 50; ++i) {
    RandomStream stream(2, kEvaluationTasks, i);
    tasks.push_back(GenerateTask(config.task, stream));
  }
  const auto play = [&](const std::string& name) {
    const auto agent = LoadAgent(name, {*sand, {}, 0.1, "cpu"});
    return Evaluate(*agent, world, EpisodeConfigFor(*agent, {}), tasks, 3);
  };
  const Evaluation policy = play((folder / "agent.safetensors").string()), random = play("random");
  int wins = 0;
  for (size_t i = 0; i < tasks.size(); ++i)
    wins += policy.per_task[i].at("in_goal_mean_diff_mm") <
            random.per_task[i].at("in_goal_mean_diff_mm");
  EXPECT_GE(wins, 40);
  // Doing nothing would beat random, too: the policy must shape.
  EXPECT_LT(policy.Mean("in_goal_mean_diff_mm"), policy.Mean("in_goal_mean_diff_start_mm"));
  RecordProperty("wins_of_50", wins);
  RecordProperty("policy_um", static_cast<int>(1e3 * policy.Mean("in_goal_mean_diff_mm")));
  RecordProperty("start_um", static_cast<int>(1e3 * policy.Mean("in_goal_mean_diff_start_mm")));
}

}  // namespace
}  // namespace sandwright
