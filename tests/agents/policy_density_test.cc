// The density of the sand's policy over whole strokes: sampled and evaluated alike, and of mass 1.
#include <gtest/gtest.h>

#include "agents/networks.h"
#include "env/action.h"
#include "env/observation.h"

namespace sandwright {
namespace {

struct RandomPolicy {
  ObservationSpec spec = SpecOf({.rows = 8, .columns = 8});
  NetworkConfig config{.channels = 4, .hidden = 8, .headings = 4, .first_guess = {}};
  RandomStream stream{7};
  ActorCritic network{spec, kActionSize, config, stream};
  ObservationTensors observation;

  RandomPolicy() {
    torch::manual_seed(5);
    const torch::NoGradGuard no_grad;
    for (auto& weight : network.parameters()) weight.copy_(0.2 * torch::randn_like(weight));
    observation = {torch::rand({2, 5, 8, 8}), torch::rand({2, 4})};
  }
};

TEST(PolicyDensity, SamplesAreEvaluatedAsTheyWereDrawn) {
  RandomPolicy s;
  std::vector<RandomStream> streams = {RandomStream(1), RandomStream(2)};
  const auto drawn = s.network.Sample(s.observation, streams, 16);
  ASSERT_EQ(drawn.action.sizes(), (std::vector<int64_t>{32, kActionSize}));
  const auto repeat = [](const torch::Tensor& t) { return t.repeat_interleave(16, 0); };
  const auto terms =
      s.network.Evaluate({repeat(s.observation.map), repeat(s.observation.vec)}, drawn.action);
  EXPECT_TRUE(torch::allclose(terms.log_prob, drawn.log_prob, 1e-3, 1e-3))
      << (terms.log_prob - drawn.log_prob).abs().max();
  EXPECT_TRUE(torch::allclose(terms.value, drawn.value, 1e-5, 1e-5));
  const auto grouped = s.network.Evaluate(s.observation, drawn.action);
  EXPECT_TRUE(torch::allclose(grouped.log_prob, terms.log_prob, 1e-4, 1e-4));
  EXPECT_TRUE(torch::allclose(grouped.entropy, terms.entropy, 1e-4, 1e-4));
}

TEST(PolicyDensity, DrawsOfARowDoNotDependOnTheOthers) {
  RandomPolicy s;
  std::vector<RandomStream> both = {RandomStream(1), RandomStream(2)}, second = {RandomStream(2)};
  const auto all = s.network.Sample(s.observation, both, 3).action;
  const auto alone =
      s.network
          .Sample({s.observation.map.narrow(0, 1, 1), s.observation.vec.narrow(0, 1, 1)}, second, 3)
          .action;
  EXPECT_TRUE(torch::allclose(all.narrow(0, 3, 3), alone, 1e-5, 1e-5));
}

// E over the policy of 1 / p over a region is the region's volume: here all of [-1, 1]^7.
TEST(PolicyDensity, HasMassOne) {
  RandomPolicy s;
  std::vector<RandomStream> streams = {RandomStream(1), RandomStream(2)};
  const int draws = 40000;
  // Uniform points: E[p] = 1 / volume.
  RandomStream uniform(9);
  auto action = torch::empty({draws, kActionSize});
  for (int64_t i = 0; i < action.numel(); ++i)
    action.data_ptr<float>()[i] = static_cast<float>(uniform.Uniform(-1, 1));
  const torch::NoGradGuard no_grad;
  double sum = 0, squares = 0;
  for (const auto& part : action.split(2000)) {
    const auto expand = [&](const torch::Tensor& t) {
      std::vector<int64_t> size = t.sizes().vec();
      size[0] = part.size(0);
      return t.narrow(0, 0, 1).expand(size);
    };
    const auto mass = (s.network.Evaluate({expand(s.observation.map), expand(s.observation.vec)}, part)
                           .log_prob.exp() *
                       std::pow(2.0, kActionSize))
                          .to(torch::kFloat64);
    sum += mass.sum().item<double>();
    squares += mass.square().sum().item<double>();
  }
  const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
  EXPECT_LT(error, 0.1);
  EXPECT_NEAR(mean, 1.0, 4 * error);
}

}  // namespace
}  // namespace sandwright
