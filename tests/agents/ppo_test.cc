#include "agents/ppo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/error.h"
#include "toy_envs.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;

std::vector<float> ParametersOf(const ActorCritic& network) {
  std::vector<float> all;
  for (const auto& p : network.parameters()) {
    const auto flat = p.detach().contiguous();
    all.insert(all.end(), flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel());
  }
  return all;
}

TEST(EstimateAdvantages, HandNumbers) {
  // One environment, gamma 0.5, lambda 0.5; deltas: 1 + 0.5*2 - 1 =
  // 1, 0 + 0.5*4 - 2 = 0, 2 + 0.5*6 - 4 = 1.
  const std::vector<float> reward = {1, 0, 2}, value = {1, 2, 4}, next = {2, 4, 6};
  const std::vector<uint8_t> ends = {0, 0, 0};
  const Advantages a = EstimateAdvantages(reward, value, next, ends, 1, 0.5, 0.5);
  EXPECT_THAT(a.advantage,
              ElementsAre(FloatNear(1.0625f, 1e-6f), FloatNear(0.25f, 1e-6f), FloatNear(1, 1e-6f)));
  EXPECT_THAT(a.value_target,
              ElementsAre(FloatNear(2.0625f, 1e-6f), FloatNear(2.25f, 1e-6f), FloatNear(5, 1e-6f)));
}

TEST(EstimateAdvantages, TerminationAndTruncation) {
  // Two environments, step-major. Environment 0 terminates at step 0: nothing follows it.
  // Environment 1 is truncated there: V(final observation) = 10 follows, but no later advantage.
  const std::vector<float> reward = {1, 1, 5, 5}, value = {2, 2, 3, 3}, next = {0, 10, 0, 0};
  const std::vector<uint8_t> ends = {1, 1, 1, 1};
  const Advantages a = EstimateAdvantages(reward, value, next, ends, 2, 0.9, 0.95);
  EXPECT_THAT(a.advantage, ElementsAre(FloatNear(-1, 1e-6f), FloatNear(1 + 9 - 2, 1e-5f),
                                       FloatNear(2, 1e-6f), FloatNear(2, 1e-6f)));
}

// Rewards 1 a step, truncated every second step, with a constant observation: V is the value of
// going on for ever. A trainer that takes truncation for an end would find at most 1 + gamma.
class EndlessReward final : public VecEnv {
 public:
  EndlessReward() { spec_.numbers = {"one"}; }
  int num_envs() const override { return 2; }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return 1; }
  ObservationBatch Reset(uint64_t) override { return {{}, {1, 1}}; }
  StepBatch Step(std::span<const float>) override {
    ++step_;
    const uint8_t cut = step_ % 2 == 0;
    return {{{}, {1, 1}}, {{}, {1.0f * cut, 1.0f * cut}}, {1, 1}, {0, 0}, {cut, cut}, {}};
  }

 private:
  ObservationSpec spec_;
  int step_ = 0;
};

TEST(Ppo, TruncationBootstrapsTheFinalObservation) {
  torch::set_num_threads(1);
  EndlessReward env;
  RandomStream stream(1);
  ActorCritic network(env.observation_spec(), 1, {.hidden = 16}, stream);
  PpoConfig config{
      .num_steps = 32, .minibatch_size = 64, .gamma = 0.8, .learning_rate = 0.01, .target_kl = 0};
  const int64_t total = 120 * 64;
  Ppo ppo(env, network, config, total, 1, torch::kCPU);
  while (ppo.steps() < total) ppo.Update();
  const double value = network.Value({{}, torch::ones({1, 1})}).item<double>();
  EXPECT_NEAR(value, 1.0 / (1.0 - 0.8), 0.1);
}

TEST(NormalizedAdvantages, AFloorKeepsNoiseSmall) {
  const auto advantage = torch::tensor({1.0f, 2.0f, 3.0f});  // deviation 1
  const auto shares = torch::tensor({-1.0f, 0.0f, 1.0f});
  EXPECT_TRUE(torch::allclose(NormalizedAdvantages(advantage, 0.5), shares));
  EXPECT_TRUE(torch::allclose(NormalizedAdvantages(advantage, 4), shares / 4));
  EXPECT_TRUE(torch::allclose(NormalizedAdvantages(advantage / 1000, 0.5), shares / 500));
}

TEST(FlatAdam, MatchesTorch) {
  torch::manual_seed(0);
  torch::nn::Linear ours(4, 3), theirs(4, 3);
  {
    const torch::NoGradGuard no_grad;
    ours->weight.copy_(theirs->weight);
    ours->bias.copy_(theirs->bias);
  }
  FlatAdam flat(ours->parameters(), 1e-5);
  torch::optim::Adam reference(theirs->parameters(), torch::optim::AdamOptions(0.01).eps(1e-5));
  for (int i = 0; i < 20; ++i) {
    const auto x = torch::randn({8, 4});
    flat.ZeroGradients();
    reference.zero_grad();
    ours(x).square().mean().backward();
    theirs(x).square().mean().backward();
    const double norm = torch::nn::utils::clip_grad_norm_(theirs->parameters(), 0.1);
    EXPECT_NEAR(flat.ClipGradients(0.1), norm, 1e-5);
    flat.Step(0.01);
    reference.step();
  }
  EXPECT_TRUE(torch::allclose(ours->weight, theirs->weight, 1e-4, 1e-6));
  EXPECT_TRUE(torch::allclose(ours->bias, theirs->bias, 1e-4, 1e-6));
}

struct Trainee {
  explicit Trainee(uint64_t seed, float reward_unit = 1)
      : env(8, reward_unit),
        stream(seed),
        network(env.observation_spec(), 1, {.hidden = 16, .normalize = true}, stream),
        ppo(env, network,
            {.num_steps = 16, .minibatch_size = 32, .scale_rewards = true},
            4096, seed, torch::kCPU) {
    torch::set_num_threads(1);
  }
  MoveToTarget env;
  RandomStream stream;
  ActorCritic network;
  Ppo ppo;
};

TEST(Ppo, TheSameSeedGivesTheSameParameters) {
  Trainee first(7), second(7), other(8);
  for (int i = 0; i < 4; ++i) first.ppo.Update(), second.ppo.Update(), other.ppo.Update();
  EXPECT_EQ(ParametersOf(first.network), ParametersOf(second.network));
  EXPECT_NE(ParametersOf(first.network), ParametersOf(other.network));
}

TEST(Ppo, ResumedEqualsUninterrupted) {
  Trainee whole(7);
  for (int i = 0; i < 3; ++i) whole.ppo.Update();
  whole.ppo.RestartEpisodes();
  Safetensors saved;
  whole.ppo.Save(saved);
  Trainee resumed(7);
  resumed.ppo.Load(saved, "test");
  for (int i = 0; i < 3; ++i) whole.ppo.Update(), resumed.ppo.Update();
  EXPECT_EQ(whole.ppo.steps(), resumed.ppo.steps());
  EXPECT_EQ(ParametersOf(whole.network), ParametersOf(resumed.network));
}

TEST(Ppo, ScaledRewardsHaveNoUnit) {
  // A power of two, so that not even roundings differ.
  Trainee metres(7), kibimetres(7, 1.0f / 1024);
  for (int i = 0; i < 3; ++i) metres.ppo.Update(), kibimetres.ppo.Update();
  EXPECT_EQ(ParametersOf(metres.network), ParametersOf(kibimetres.network));
}

TEST(Ppo, TheFloorOfAdvantagesIsInTheUnitOfReturns) {
  torch::set_num_threads(1);
  const auto floor = [](float reward_unit, bool scale_rewards) {
    MoveToTarget env(8, reward_unit);
    RandomStream stream(1);
    ActorCritic network(env.observation_spec(), 1, {.hidden = 16}, stream);
    Ppo ppo(env, network,
            {.num_steps = 16, .scale_rewards = scale_rewards, .advantage_floor = 0.25}, 4096, 1,
            torch::kCPU);
    return ppo.Update().advantage_floor;
  };
  EXPECT_GT(floor(1, false), 0.01);
  EXPECT_DOUBLE_EQ(floor(1024, false), 1024 * floor(1, false));
  EXPECT_EQ(floor(1024, true), 0.25);
}

TEST(Ppo, ForeignStateIsRefused) {
  Trainee trainer(7);
  Safetensors saved;
  EXPECT_THROW(trainer.ppo.Load(saved, "file"), Error);
  trainer.ppo.Save(saved);
  saved.tensors["ppo.first_moment"] = {{1}, {0}};
  EXPECT_THROW(trainer.ppo.Load(saved, "file"), Error);
}

TEST(Ppo, SchedulesFallWithTheSteps) {
  torch::set_num_threads(1);
  MoveToTarget env(8);
  RandomStream stream(1);
  ActorCritic network(env.observation_spec(), 1, {.hidden = 16}, stream);
  Ppo ppo(env, network,
          {.num_steps = 16, .learning_rate = 0.01, .clip_range = 0.4,
           .clip_range_schedule = "linear"},
          4 * 128, 1, torch::kCPU);
  for (const double left : {1.0, 0.75, 0.5, 0.25}) {
    const PpoReport report = ppo.Update();
    EXPECT_DOUBLE_EQ(report.learning_rate, 0.01 * left);
    EXPECT_DOUBLE_EQ(report.clip_range, 0.4 * left);
  }
}

TEST(Ppo, AdaptiveRateAimsAtTheKl) {
  EXPECT_DOUBLE_EQ(AdaptedRate(0.003, 0.021, 0.01), 0.002);
  EXPECT_DOUBLE_EQ(AdaptedRate(0.002, 0.004, 0.01), 0.003);
  EXPECT_DOUBLE_EQ(AdaptedRate(0.002, 0.012, 0.01), 0.002);
  EXPECT_DOUBLE_EQ(AdaptedRate(1e-6, 1, 0.01), 1e-6);
  EXPECT_DOUBLE_EQ(AdaptedRate(1e-2, 0, 0.01), 1e-2);
  torch::set_num_threads(1);
  MoveToTarget env(8);
  RandomStream stream(1);
  ActorCritic network(env.observation_spec(), 1, {.hidden = 16}, stream);
  const PpoConfig config{.num_steps = 16,
                         .learning_rate = 0.01,
                         .learning_rate_schedule = "adaptive",
                         .target_kl = 1e-4};
  Ppo ppo(env, network, config, 4096, 1, torch::kCPU);
  double rate = config.learning_rate;
  for (int i = 0; i < 5; ++i) {
    const PpoReport report = ppo.Update();
    EXPECT_DOUBLE_EQ(report.learning_rate, rate);
    rate = AdaptedRate(rate, report.approx_kl, config.target_kl);
  }
  EXPECT_LT(rate, config.learning_rate);
  Safetensors saved;
  ppo.Save(saved);
  Ppo resumed(env, network, config, 4096, 1, torch::kCPU);
  resumed.Load(saved, "test");
  EXPECT_DOUBLE_EQ(resumed.Update().learning_rate, rate);
}

TEST(ObservationNormalizer, ManyBatchesEqualOne) {
  torch::manual_seed(0);
  const auto rows = torch::randn({300, 2}) * torch::tensor({3.0f, 0.01f}) + 50;
  ObservationNormalizer whole(2), parts(2);
  EXPECT_TRUE(torch::equal(whole.Forward(rows.slice(0, 0, 1)).clamp(10, 10), torch::full({1, 2}, 10)));
  whole.Observe(rows);
  for (const auto& part : rows.tensor_split(7)) parts.Observe(part);
  const auto normal = whole.Forward(rows);
  EXPECT_TRUE(torch::allclose(normal.mean(0), torch::zeros({2}), 0, 1e-2));
  EXPECT_TRUE(torch::allclose(normal.var(0, false), torch::ones({2}), 1e-2));
  EXPECT_TRUE(torch::allclose(parts.Forward(rows), normal, 1e-3, 1e-2));
  EXPECT_EQ(whole.Forward(torch::full({1, 2}, 1e9f)).max().item<float>(), 10.0f);
}

TEST(PpoLearning, WalksToTheTarget) {
  torch::set_num_threads(1);
  MoveToTarget env(16);
  RandomStream stream(1);
  ActorCritic network(env.observation_spec(), 1, {.hidden = 32}, stream);
  const int64_t total = 40 * 16 * 64;
  Ppo ppo(env, network, {.num_steps = 64, .minibatch_size = 128, .learning_rate = 3e-3}, total, 1,
          torch::kCPU);
  PpoReport last;
  while (ppo.steps() < total) last = ppo.Update();
  double distance = 0;
  for (const auto& episode : last.finished) distance += episode.metrics.at("distance");
  distance /= static_cast<double>(last.finished.size());
  EXPECT_LT(distance, 0.06);  // arriving ends an episode within 0.05; a random walk ends at 0.6
  EXPECT_GT(last.explained_variance, 0.8);
}

TEST(PpoLearning, HitsOneOfTwoSpotsAtAHeadingThatWraps) {
  torch::set_num_threads(1);
  HitTheSpot env(64);
  RandomStream stream(1);
  ActorCritic network(env.observation_spec(), 4, {.channels = 8, .hidden = 32, .headings = 8},
                      stream);
  const int64_t total = 80 * 64 * 8;
  Ppo ppo(env, network,
          {.num_steps = 8, .minibatch_size = 128, .learning_rate = 3e-3, .target_kl = 0.1}, total,
          1, torch::kCPU);
  PpoReport first = ppo.Update(), last;
  while (ppo.steps() < total) last = ppo.Update();
  const auto mean_return = [](const PpoReport& report) {
    double sum = 0;
    for (const auto& episode : report.finished) sum += episode.episode_return;
    return sum / static_cast<double>(report.finished.size());
  };
  EXPECT_LT(mean_return(first), 0.2);
  EXPECT_GT(mean_return(last), 0.75);
}

}  // namespace
}  // namespace sandwright
