// Learning, shown: policies trained here and now, on the small bed, against random strokes on tasks that
// no training saw.
#include <gtest/gtest.h>

#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "env/load_gate.h"
#include "agents/train.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

struct Comparison {
  int wins_of_50 = 0;  // against random
  double policy_mm = 0, start_mm = 0;
};

// The policy at the end of training against random strokes, on 50 tasks that no training saw.
Comparison TrainAndCompare(TrainConfig config, const std::string& name) {
  config.device = "cpu";
  config.evaluate_every = config.checkpoint_every = 0;
  const auto folder = std::filesystem::path(::testing::TempDir()) / "learning_test" / name;
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
  const auto play = [&](const std::string& agent_name) {
    const auto agent = LoadAgent(agent_name, {*sand, {}, 0.1, "cpu"});
    return Evaluate(*agent, world, EpisodeConfigFor(*agent, {}), tasks, 3);
  };
  const Evaluation policy = play((folder / "agent.safetensors").string()), random = play("random");
  Comparison result{.policy_mm = policy.Mean("in_goal_mean_diff_mm"),
                    .start_mm = policy.Mean("in_goal_mean_diff_start_mm")};
  for (size_t i = 0; i < tasks.size(); ++i)
    result.wins_of_50 += policy.per_task[i].at("in_goal_mean_diff_mm") <
                         random.per_task[i].at("in_goal_mean_diff_mm");
  return result;
}

TEST(Learning, AMinuteOfPpoBeatsRandomOnUnseenTasks) {
  TrainConfig config;
  LoadYaml(FieldsOf(config), SANDWRIGHT_ROOT "/configs/train_ppo_small.yaml");
  config.workcell = SANDWRIGHT_ROOT "/configs/" + config.workcell;
  const Comparison result = TrainAndCompare(config, "ppo");
  EXPECT_GE(result.wins_of_50, 40);
  // Doing nothing would beat random, too: the policy must shape.
  EXPECT_LT(result.policy_mm, result.start_mm);
}

TEST(Learning, TwoThousandStrokesOfAnExpertBeatRandomOnUnseenTasks) {
  TrainConfig config;
  config.algorithm = "expert_iteration";
  config.total_steps = 2048;
  config.expert.evaluations = 32;
  const Comparison result = TrainAndCompare(config, "expert");
  EXPECT_GE(result.wins_of_50, 45);
  EXPECT_LT(result.policy_mm, result.start_mm);
}

TEST(Learning, GroupsOfStrokesTeachAPolicyAlone) {
  TrainConfig config;
  config.algorithm = "group_gradient";
  config.total_steps = 2560;
  config.env.num_envs = 32;
  config.group.num_steps = 10;
  config.group.strokes = 32;
  const Comparison result = TrainAndCompare(config, "group");
  EXPECT_GE(result.wins_of_50, 45);
  EXPECT_LT(result.policy_mm, result.start_mm);
}

}  // namespace
}  // namespace sandwright
