// SAC and TQC: the policy's density, the critics' rules, exact repetition, a toy task learnt.
#include "agents/sac.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "agents/colored_noise.h"
#include "agents/tqc.h"
#include "data/base/error.h"
#include "env/reference/reference_vec_env.h"
#include "toy_envs.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(SquashedGaussian, DensityIntegratesToOneOverTheActions) {
  for (const auto& [mean, log_std] : {std::pair{0.0, 0.0}, {0.7, -1.0}, {-1.5, 0.3}}) {
    // Evenly in the Gaussian's own numbers: d(action) = (1 - action^2) du.
    constexpr int64_t n = 20001;
    const auto noise = torch::linspace(-8, 8, n, torch::kFloat64).unsqueeze(1);
    const SquashedGaussian p{torch::full({n, 1}, mean, torch::kFloat64),
                             torch::full({n, 1}, log_std, torch::kFloat64)};
    const SquashedDraw draw = Squash(p, noise);
    const auto a = draw.action.squeeze(1);
    const auto area = draw.log_prob.exp() * (1 - a.square()) * std::exp(log_std) * (16.0 / (n - 1));
    EXPECT_NEAR(area.sum().item<double>(), 1.0, 1e-6) << mean;
  }
}

TEST(SquashedGaussian, LogDensityHoldsWhereTanhIsOneInFloat) {
  const SquashedGaussian p{torch::full({1, 1}, 20.0f).requires_grad_(), torch::zeros({1, 1})};
  const SquashedDraw draw = Squash(p, torch::zeros({1, 1}));
  EXPECT_EQ(draw.action.item<float>(), 1.0f);
  // log N(0) - log(1 - tanh(20)^2), and 1 - tanh(u)^2 = 4 exp(-2 u) up here.
  EXPECT_NEAR(draw.log_prob.item<double>(), -0.918939 - (std::log(4.0) - 40.0), 1e-4);
  draw.log_prob.sum().backward();
  EXPECT_NEAR(p.mean.grad().item<double>(), 2.0, 1e-6);
}

TEST(SquashedGaussian, OutputsAreHeldWithinBounds) {
  const auto p = SquashedFromOutputs(torch::tensor({{0.5f, 9.0f, -50.0f, 50.0f}}));
  EXPECT_TRUE(torch::equal(p.mean, torch::tensor({{0.5f, 9.0f}})));
  EXPECT_TRUE(torch::equal(p.log_std, torch::tensor({{-20.0f, 2.0f}})));
}

TEST(ColoredNoise, IsStandardNormalAndOfItsColour) {
  constexpr int kSeries = 400, kCount = 256;
  for (const double color : {0.0, 1.0, 2.0}) {
    RandomStream stream(5);
    double squares = 0, neighbours = 0;
    for (int i = 0; i < kSeries; ++i) {
      const auto x = ColoredNoise(kCount, color, stream);
      for (size_t t = 0; t + 1 < x.size(); ++t) {
        squares += x[t] * x[t] / (kSeries * (kCount - 1.0));
        neighbours += x[t] * x[t + 1] / (kSeries * (kCount - 1.0));
      }
    }
    EXPECT_NEAR(squares, 1.0, 0.12) << color;
    // The autocorrelation of power k^-color over k = 0 (as 1), 1 ... n/2 at one step.
    double power = 0, expected = 0;
    for (int k = 0; k <= kCount / 2; ++k) {
      const double p = std::pow(std::max(k, 1), -color) * (k == 0 || 2 * k == kCount ? 1 : 2);
      power += p, expected += p * std::cos(2 * M_PI * k / kCount);
    }
    EXPECT_NEAR(neighbours, expected / power, 0.12) << color;
  }
}

TEST(TwinCritics, TheLesserCounts) {
  const CriticRule rule = TwinCritics();
  const auto q = torch::tensor({1.0f, 5.0f, 3.0f, 2.0f}).view({2, 2, 1});
  EXPECT_TRUE(torch::equal(rule.value(q), torch::tensor({1.0f, 2.0f})));
  EXPECT_TRUE(torch::equal(rule.next_value(q), torch::tensor({{1.0f}, {2.0f}})));
  // Half of (0 + 4) for the first row, of (16 + 1) for the second.
  EXPECT_FLOAT_EQ(rule.loss(q, torch::tensor({{1.0f}, {1.0f}})).item<float>(), (4 + 17) / 4.0f);
}

TEST(Truncated, DropsTheGreatestOfThePool) {
  const auto quantiles = torch::tensor({4.0f, 9.0f, 1.0f, 8.0f, 7.0f, 2.0f}).view({2, 1, 3});
  EXPECT_TRUE(torch::equal(Truncated(quantiles, 1), torch::tensor({{1.0f, 2.0f, 4.0f, 7.0f}})));
  EXPECT_EQ(Truncated(quantiles, 0).size(1), 6);
  EXPECT_THAT([] { TruncatedQuantileCritics({.quantiles = 5, .dropped = 5}); },
              ThrowsMessage<Error>(HasSubstr("less than tqc.quantiles = 5")));
}

TEST(QuantileHuberLoss, EqualsTheTensorsOfAllPairs) {
  torch::manual_seed(0);
  const auto ours = torch::randn({2, 3, 5}).mul(2).requires_grad_();
  const auto theirs = ours.detach().clone().requires_grad_();
  const auto samples = torch::randn({3, 8}).mul(2);
  const auto error = samples.view({1, 3, 1, 8}) - theirs.unsqueeze(-1);
  const auto level = ((torch::arange(5) + 0.5) / 5).view({1, 1, 5, 1});
  const auto huber = torch::where(error.abs() > 1, error.abs() - 0.5, 0.5 * error.square());
  const auto expected = ((level - (error < 0).to(torch::kFloat32)).abs() * huber).mean();
  const auto loss = QuantileHuberLoss(ours, samples);
  EXPECT_NEAR(loss.item<double>(), expected.item<double>(), 1e-6);
  loss.backward();
  expected.backward();
  EXPECT_TRUE(torch::allclose(ours.grad(), theirs.grad(), 1e-4, 1e-7));
}

struct Trainee {
  explicit Trainee(uint64_t seed, CriticRule rule = TwinCritics(), double noise_color = 0)
      : env(2),
        sac((torch::set_num_threads(1), env),
            {.batch_size = 16,
             .buffer_size = 600,  // overwritten within a stretch
             .random_steps = 40,
             .train_every = 4,
             .gradient_steps = 2,
             .n_step = 3,
             .network = {.hidden = 16},
             .noise_color = noise_color},
            std::move(rule), seed, torch::kCPU) {}
  std::map<std::string, std::vector<float>> State() const {
    Safetensors content;
    sac.Save(content);
    std::map<std::string, std::vector<float>> values;
    for (const auto& [name, tensor] : content.tensors) values[name] = tensor.values;
    return values;
  }
  MoveToTarget env;
  Sac sac;
};

TEST(Sac, TheSameSeedGivesTheSameParameters) {
  Trainee first(7), second(7), other(8);
  for (Trainee* t : {&first, &second, &other}) t->sac.Advance();
  EXPECT_TRUE(first.State() == second.State());  // EXPECT_EQ would print them
  EXPECT_FALSE(first.State() == other.State());
}

TEST(Sac, ResumedEqualsUninterrupted) {
  const std::function<CriticRule()> rules[] = {
      TwinCritics, [] { return TruncatedQuantileCritics({.critics = 3, .quantiles = 4}); }};
  for (const auto& rule : rules) {
    Trainee whole(7, rule(), 1);
    for (int i = 0; i < 2; ++i) whole.sac.Advance();
    whole.sac.RestartEpisodes();
    Safetensors saved;
    whole.sac.Save(saved);
    // Through the file's format: everything is floats and text.
    const auto file = std::filesystem::path(::testing::TempDir()) / "sac_test.safetensors";
    WriteSafetensors(saved, file);
    Trainee resumed(7, rule(), 1);
    resumed.sac.Load(ReadSafetensors(file), file.string());
    EXPECT_TRUE(resumed.State() == whole.State());
    for (int i = 0; i < 2; ++i) whole.sac.Advance(), resumed.sac.Advance();
    EXPECT_EQ(resumed.sac.steps(), whole.sac.steps());
    EXPECT_TRUE(resumed.State() == whole.State());
  }
}

TEST(Sac, ForeignStateIsRefused) {
  Trainee sac(7), tqc(7, TruncatedQuantileCritics({}));
  Safetensors saved;
  EXPECT_THROW(sac.sac.Load(saved, "file"), Error);
  tqc.sac.Save(saved);
  EXPECT_THAT([&] { sac.sac.Load(saved, "file"); },
              ThrowsMessage<Error>(HasSubstr("file: weights 'heads.weight2' have shape [2, 16, 25]")));
}

TEST(Sac, ChoicesAreRefused) {
  ReferenceVecEnv env("CartPole-v1", 1);
  EXPECT_THAT([&] { Sac(env, {}, TwinCritics(), 1, torch::kCPU); },
              ThrowsMessage<Error>(HasSubstr("one of 2 choices; allowed here: algorithm = ppo")));
}

TEST(Sac, TheTemperatureSeeksItsEntropy) {
  // From an entropy above -1 (one number) it can only fall.
  Trainee trainee(7);
  auto scalars = trainee.sac.Advance();
  EXPECT_GT(scalars.at("train/entropy"), -1);
  EXPECT_LT(scalars.at("train/ent_coef"), 1);
}

// Rewards 1 a step, truncated every second step: see ppo_test.
class EndlessReward final : public VecEnv {
 public:
  explicit EndlessReward(bool terminates) : terminates_(terminates) { spec_.numbers = {"one"}; }
  int num_envs() const override { return 1; }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return 1; }
  ObservationBatch Reset(uint64_t) override { return {{}, {1}}; }
  StepBatch Step(std::span<const float>) override {
    const uint8_t end = ++step_ % 2 == 0;
    return {{{}, {1}}, {{}, {1.0f * end}}, {1}, {static_cast<uint8_t>(end && terminates_)},
            {static_cast<uint8_t>(end && !terminates_)}, {}};
  }

 private:
  bool terminates_;
  ObservationSpec spec_;
  int step_ = 0;
};

TEST(SacLearning, TruncationGoesOnAndTerminationDoesNot) {
  torch::set_num_threads(1);
  for (const auto& [terminates, n_step] : {std::pair<bool, int64_t>{false, 1}, {true, 1}, {false, 3}, {true, 3}}) {
    EndlessReward env(terminates);
    Sac sac(env,
            {.learning_rate = 3e-3,
             .gamma = 0.8,
             .target_share = 0.1,
             .batch_size = 32,
             .n_step = n_step,
             .network = {.hidden = 16},
             .temperature = 1e-6},
            TwinCritics(), 1, torch::kCPU);
    for (int i = 0; i < 3; ++i) sac.Advance();
    // For ever 1 / (1 - 0.8) = 5. Terminated with even odds: v = 1 + 0.4 v; the rewards of more steps tell a
    // first step (1 + 0.8) from a last one (1), which look alike.
    Safetensors saved;
    sac.Save(saved);
    RandomStream unused(0);
    Perceptron critics(2, 2, 16, 1, unused);
    LoadWeights(saved, "critics.heads.", "test", critics);
    const auto q = critics.Forward(torch::tensor({{1.0f, 0.0f}}));
    const double expected = !terminates ? 5.0 : n_step == 1 ? 1 / 0.6 : (1.8 + 1) / 2;
    EXPECT_NEAR(q.mean().item<double>(), expected, terminates ? 0.2 : 0.4);
  }
}

TEST(SacLearning, HitsTheSpotOfAMap) {
  torch::set_num_threads(1);
  HitTheSpot env(8);
  Sac sac(env, {.learning_rate = 1e-3, .batch_size = 64, .buffer_size = 4000, .train_every = 8,
                .gradient_steps = 8, .network = {.hidden = 64, .channels = 8, .features = 32}},
          TwinCritics(), 1, torch::kCPU);
  std::map<std::string, double> first, last;
  for (int i = 0; i < 6; ++i) (i == 0 ? first : last) = sac.Advance();
  EXPECT_GT(last.at("rollout/ep_rew_mean"), first.at("rollout/ep_rew_mean") + 0.3);
}

TEST(SacLearning, WalksToTheTarget) {
  torch::set_num_threads(1);
  for (const bool quantiles : {false, true}) {
    MoveToTarget env(4);
    const SacConfig config{.learning_rate = 3e-3,
                           .gamma = 0.9,
                           .target_share = 0.02,
                           .batch_size = 64,
                           .network = {.hidden = 32}};
    Sac sac(env, config, quantiles ? TruncatedQuantileCritics({}) : TwinCritics(), 1, torch::kCPU);
    std::map<std::string, double> last;
    for (int i = 0; i < 8; ++i) last = sac.Advance();
    // Arriving ends an episode within 0.05; a random walk ends at 0.6.
    EXPECT_LT(last.at("rollout/distance"), 0.08) << quantiles;
  }
}

}  // namespace
}  // namespace sandwright
