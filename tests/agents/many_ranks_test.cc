// A run spread over ranks is the run of one rank: with threads for ranks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "agents/run_folder.h"
#include "agents/train.h"
#include "data/base/error.h"
#include "env/safetensors.h"
#include "tests/support/thread_ranks.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::filesystem::path Folder(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "many_ranks_test" / name;
  std::filesystem::remove_all(folder);
  return folder;
}

// One update of 8 steps of 8 environments in two minibatches an epoch, the last with a remainder.
TrainConfig OneUpdate() {
  TrainConfig config;
  config.total_steps = 64;
  config.device = "cpu";
  config.evaluate_every = 0;
  config.evaluation_tasks = 2;
  config.env.num_envs = 8;
  config.network.hidden = 8;
  config.network.normalize = true;
  config.ppo.num_steps = 8;
  config.ppo.minibatch_size = 31;
  config.ppo.scale_rewards = true;
  return config;
}

TrainConfig OnSand() {
  TrainConfig config = OneUpdate();
  config.task.cell_size_m = 0.02;
  config.task.max_strokes = 5;
  config.env.observation.rows = config.env.observation.columns = 12;
  config.network.channels = 4;
  config.network.headings = 4;
  return config;
}

TrainConfig OnReference(const std::string& task) {
  TrainConfig config = OneUpdate();
  config.reference = task;
  config.ppo.num_steps = 40;  // CartPole's first episodes end within
  config.total_steps = 320;
  return config;
}

std::vector<std::exception_ptr> TrainOn(int size, const TrainConfig& config,
                                        const std::filesystem::path& folder, bool resume = false) {
  return ThreadRanks(size).Run([&](Collective& ranks) {
    Train(config, {.folder = folder, .seed = 3, .resume = resume, .ranks = &ranks});
  });
}

// The largest difference of any number that the last checkpoints hold, moments and statistics included.
double Distance(const std::filesystem::path& a, const std::filesystem::path& b) {
  const Safetensors one = ReadSafetensors(LastCheckpoint(a)), other = ReadSafetensors(LastCheckpoint(b));
  EXPECT_EQ(one.tensors.size(), other.tensors.size());
  double farthest = 0;
  for (const auto& [name, tensor] : one.tensors) {
    const NamedTensor& same = other.Tensor(name, b.string());
    for (size_t i = 0; i < tensor.values.size(); ++i)
      farthest = std::max<double>(farthest, std::abs(tensor.values[i] - same.values.at(i)));
  }
  return farthest;
}

void ExpectNoneThrew(const std::vector<std::exception_ptr>& thrown) {
  for (const auto& fault : thrown)
    if (fault) std::rethrow_exception(fault);
}

class ManyRanks : public ::testing::TestWithParam<std::string> {
 protected:
  TrainConfig Config() const { return GetParam() == "sand" ? OnSand() : OnReference(GetParam()); }
};

TEST_P(ManyRanks, AnUpdateIsThatOfOneRank) {
  const auto alone = Folder(GetParam() + "_alone");
  ExpectNoneThrew(TrainOn(1, Config(), alone));
  for (const int size : {2, 4}) {
    const auto spread = Folder(GetParam() + "_spread");
    ExpectNoneThrew(TrainOn(size, Config(), spread));
    EXPECT_LT(Distance(alone, spread), 1e-5) << size;
    // Noise and shuffling go on from the same places: a run may go on with another number of ranks.
    const auto state = [](const std::filesystem::path& folder) {
      return nlohmann::json::parse(
          ReadSafetensors(LastCheckpoint(folder)).Metadata("ppo_state", folder.string()));
    };
    const nlohmann::json one = state(alone), other = state(spread);
    for (const char* key : {"steps", "shuffle", "action"})
      EXPECT_EQ(one.at(key), other.at(key)) << key;
    for (const char* key : {"count", "mean", "squares"})  // rewards of actions that differ in the last bit
      EXPECT_NEAR(one.at("returns").at(key).get<double>(), other.at("returns").at(key).get<double>(), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Tasks, ManyRanks,
                         ::testing::Values("sand", "CartPole-v1", "Pendulum-v1", "HalfCheetah-v4"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(ManyRanks, AdaptedRatesAgreeAndARunGoesOnWithAnotherNumber) {
  TrainConfig config = OnReference("CartPole-v1");
  config.ppo.learning_rate_schedule = "adaptive";
  config.total_steps = config.checkpoint_every = 640;
  const auto alone = Folder("adaptive_alone"), spread = Folder("adaptive_spread");
  ExpectNoneThrew(TrainOn(1, config, alone));
  ExpectNoneThrew(TrainOn(2, config, spread));
  EXPECT_LT(Distance(alone, spread), 1e-4);  // of two updates
  config.total_steps = 960;
  ExpectNoneThrew(TrainOn(4, config, spread, true));
  ExpectNoneThrew(TrainOn(1, config, alone, true));
  EXPECT_LT(Distance(alone, spread), 1e-3);
}

// A rank whose arithmetic is wrong.
class Miscounting final : public Collective {
 public:
  explicit Miscounting(Collective& ranks) : Collective(ranks.rank(), ranks.size()), ranks_(ranks) {}
  void Sum(std::span<float> numbers) override {
    ranks_.Sum(numbers);
    if (rank() == 1 && ++sums_ > 4) numbers[0] += 1e-3f;
  }
  std::vector<std::byte> Gather(std::span<const std::byte> mine) override { return ranks_.Gather(mine); }
  void CheckIn() override { ranks_.CheckIn(); }
  void Leave() override { ranks_.Leave(); }

 private:
  Collective& ranks_;
  int sums_ = 0;
};

TEST(ManyRanks, OtherParametersEndTheRunAndTheLastGoodOnesAreKept) {
  TrainConfig config = OnReference("CartPole-v1");
  config.ppo.epochs = 1;
  config.ppo.minibatch_size = 80;  // four sums an update
  config.total_steps = 960;
  config.checkpoint_every = 0;
  const auto folder = Folder("miscounted");
  const auto thrown = ThreadRanks(2).Run([&](Collective& ranks) {
    Miscounting wrong(ranks);
    Train(config, {.folder = folder, .seed = 3, .ranks = &wrong});
  });
  for (const auto& fault : thrown)
    EXPECT_THAT([&] { std::rethrow_exception(fault); },
                ::testing::ThrowsMessage<Error>(AllOf(
                    HasSubstr("rank 1 differs from rank 0 after 640 steps: network."),
                    HasSubstr("continue after 320 steps with --resume"))));
  EXPECT_EQ(LastCheckpoint(folder).filename(), "000000000320.safetensors");
}

TEST(ManyRanks, WhatCannotBeSpreadIsRefused) {
  TrainConfig config = OnReference("Pendulum-v1");
  config.env.num_envs = 7;
  const auto refusal = [&] {
    const auto thrown = TrainOn(2, config, Folder("refused"));
    EXPECT_TRUE(thrown[1]);
    std::rethrow_exception(thrown[0]);
  };
  EXPECT_THAT(refusal, ::testing::ThrowsMessage<Error>("env.num_envs = 7 on 2 ranks; allowed: a multiple of 2"));
  config.algorithm = "sac";
  EXPECT_THAT(refusal, ::testing::ThrowsMessage<Error>("algorithm = sac on 2 ranks; allowed: ppo"));
}

}  // namespace
}  // namespace sandwright
